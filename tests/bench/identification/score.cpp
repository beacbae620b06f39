#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/simulation/scores.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/identification/modes.hpp"
#include "tests/bench/identification/samples.hpp"

namespace reident::bench {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::StateSpaceModel;
using identification::Vector;
using nlohmann::json;

Matrix matrix_of(const json& rows, Index columns) {
  Matrix matrix(static_cast<Index>(rows.size()), columns);
  for (Index r = 0; r < matrix.rows(); ++r)
    for (Index c = 0; c < columns; ++c)
      matrix(r, c) = rows.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c));
  return matrix;
}

Vector offset_of(const json& model, const char* key, Index channels) {
  if (!model.contains(key)) return Vector::Zero(channels);
  const auto values = model.at(key).get<std::vector<double>>();
  if (static_cast<Index>(values.size()) != channels)
    throw std::runtime_error(std::string(key) + " does not fit the samples");
  return Eigen::Map<const Vector>(values.data(), channels);
}

/// Any tool's model: A, B, C and D as arrays of rows; the offsets are 0 where they are absent.
StateSpaceModel read_model(const std::filesystem::path& file, const Record& record) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + " cannot be opened; is the path right?");
  const json text = json::parse(in);
  const auto order = static_cast<Index>(text.at("A").size());
  const Index m = record.u.cols(), p = record.y.cols();
  StateSpaceModel model;
  model.A = matrix_of(text.at("A"), order);
  model.B = matrix_of(text.at("B"), m);
  model.C = matrix_of(text.at("C"), order);
  model.D = matrix_of(text.at("D"), m);
  model.u0 = offset_of(text, "input_offset", m);
  model.y0 = offset_of(text, "output_offset", p);
  model.period_s = record.period_s;
  if (!is_well_formed(model) || model.outputs() != p)
    throw std::runtime_error(file.string() + " holds no model of these samples");
  return model;
}

struct ScoreArguments {
  std::filesystem::path file, model;
  std::pair<Index, Index> rows{0, 0};
  Index state_rows = 0;  // 0: as free_run() does
};

void score_model(const ScoreArguments& arguments) {
  const Record record = read_record(arguments.file);
  const auto& rows = arguments.rows;
  const RowRange scored{rows.first, rows.second > 0 ? rows.second : record.rows()};
  if (scored.begin < 0 || scored.begin >= scored.end || scored.end > record.rows())
    throw std::runtime_error("--rows must lie within the " + std::to_string(record.rows()) +
                             " rows of the file");
  const StateSpaceModel model = read_model(arguments.model, record);
  std::optional<Vector> x0;
  if (arguments.state_rows > 0)
    x0 = estimate_initial_state(model, record, segments_within(record, record.all()),
                                arguments.state_rows);
  const Matrix y = record.y.middleRows(scored.begin, scored.size());
  const Matrix y_hat =
      free_run(model, record, record.all(), x0).middleRows(scored.begin, scored.size());
  const identification::Score result = identification::score(y, y_hat);
  const Vector rmse = ((y - y_hat).colwise().norm() / std::sqrt(double(y.rows()))).transpose();
  const nlohmann::ordered_json text = {{"mrse_percent", result.mrse()},
                                       {"fit_percent", result.fit()},
                                       {"rmse", std::vector<double>(rmse.begin(), rmse.end())},
                                       {"pole_moduli", pole_moduli(model.A)}};
  std::printf("%s\n", text.dump().c_str());
}

}  // namespace

std::vector<double> pole_moduli(const Matrix& A) {
  const Vector moduli = A.eigenvalues().cwiseAbs();
  std::vector<double> result(moduli.begin(), moduli.end());
  std::sort(result.begin(), result.end(), std::greater<>());
  return result;
}

identification::Record read_record(const std::filesystem::path& file) {
  const Samples samples = read_samples(file);
  const Eigen::Map<const Matrix> values(samples.values.data(), samples.rows,
                                        samples.inputs + samples.outputs);
  return identification::contiguous_record(1, values.leftCols(samples.inputs),
                                           values.rightCols(samples.outputs));
}

void add_score(CLI::App& app) {
  const auto given = std::make_shared<ScoreArguments>();
  CLI::App* mode = app.add_subcommand(
      "score",
      "Free-run error of a model on all rows of the file, or on some of them; the initial state is "
      "estimated from the first rows");
  mode->add_option("file", given->file, "file of samples")->required();
  mode->add_option("model", given->model, "JSON with A, B, C, D and the offsets")->required();
  mode->add_option("--rows", given->rows, "rows BEGIN END to score, half-open");
  mode->add_option("--state-rows", given->state_rows,
                   "rows that the initial state is estimated from (500)")
      ->check(CLI::PositiveNumber);
  mode->callback([given] { score_model(*given); });
}

}  // namespace reident::bench
