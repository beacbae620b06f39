#include <cstdio>
#include <numeric>

#include <Eigen/QR>
#include <nlohmann/json.hpp>

#include "identification/subspace/hankel.hpp"
#include "identification/subspace/normalise.hpp"
#include "identification/subspace/projection.hpp"
#include "identification/subspace/shift_invariance.hpp"
#include "identification/subspace/weighting.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/identification/modes.hpp"

namespace reident::bench {
namespace {

using identification::HankelFactor;
using identification::Index;
using identification::Matrix;
using identification::Normalisation;
using identification::Projection;
using identification::Record;
using identification::Vector;
using identification::Weighting;

/// The factor of the rows without the row of ones, `mean` (m + p) added to the channels, so that
/// the projections are those of the samples as they are: other tools do not centre them.
HankelFactor uncentred(HankelFactor factor, const Vector& mean) {
  const Index m = factor.inputs, p = factor.outputs, blocks = 2 * factor.horizon;
  const double ones = factor.L(0, 0);
  factor.L.col(0).segment(1, blocks * m) += ones * mean.head(m).replicate(blocks, 1);
  factor.L.col(0).tail(blocks * p) += ones * mean.tail(p).replicate(blocks, 1);
  const Index rest = factor.L.rows() - 1;
  const Eigen::HouseholderQR<Matrix> qr(factor.L.bottomRows(rest).transpose());
  factor.L.setZero();
  factor.L.bottomRightCorner(rest, rest) =
      qr.matrixQR().topRows(rest).triangularView<Eigen::Upper>().transpose();
  return factor;
}

/// Every channel takes part, in its own unit.
Normalisation unscaled(const Record& record) {
  const Index m = record.u.cols(), p = record.y.cols();
  Normalisation result{Vector::Zero(m), Vector::Ones(m), Vector::Zero(p), Vector::Ones(p), {}, {}};
  result.inputs.resize(static_cast<std::size_t>(m));
  result.outputs.resize(static_cast<std::size_t>(p));
  std::iota(result.inputs.begin(), result.inputs.end(), Index{0});
  std::iota(result.outputs.begin(), result.outputs.end(), Index{0});
  return result;
}

nlohmann::ordered_json moesp(const HankelFactor& factor, int order) {
  const auto observability = Projection(factor).observability(Weighting::moesp);
  const auto dynamics = identification::shift_invariant(observability.gamma, factor.outputs, order);
  return {{"singular_values", to_json(observability.singular_values)},
          {"pole_moduli", pole_moduli(dynamics.A)}};
}

void run(const std::filesystem::path& file, int order, int horizon) {
  const Record record = read_record(file);
  const auto sums = sums_of_rows(record, {0, record.rows()}, 2 * Index{horizon});
  const auto from_sums = factor_of_sums(sums, unscaled(record), horizon);
  const HankelFactor from_rows = factor_of_rows(record, record.segments, horizon);
  nlohmann::ordered_json text = {
      {"rows", moesp(uncentred(from_rows, Vector::Zero(sums.mean().size())), order)}};
  if (from_sums) text["sums"] = moesp(uncentred(*from_sums, sums.mean()), order);
  std::printf("%s\n", text.dump().c_str());
}

}  // namespace

void add_subspace(CLI::App& app) {
  struct Arguments {
    std::filesystem::path file;
    int order = 0, horizon = 0;
  };
  const auto given = std::make_shared<Arguments>();
  CLI::App* mode = app.add_subcommand("subspace",
                                      "Singular values and poles by MOESP, by both ways of "
                                      "compression, from the samples as they are, for published "
                                      "figures: neither scaled nor centred");
  mode->add_option("file", given->file, "file of samples")->required();
  mode->add_option("--order", given->order)->required()->check(CLI::PositiveNumber);
  mode->add_option("--horizon", given->horizon)->required()->check(CLI::Range(2, 500));
  mode->callback([given] { run(given->file, given->order, given->horizon); });
}

}  // namespace reident::bench
