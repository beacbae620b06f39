#include <cstdio>

#include <nlohmann/json.hpp>

#include "identification/hankel.hpp"
#include "identification/subspace.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/identification/modes.hpp"

namespace reident::bench {
namespace {

using identification::HankelFactor;
using identification::Index;
using identification::Matrix;
using identification::Projection;
using identification::Record;
using identification::Weighting;

/// The factor without its row of ones, so that the projections are those of the samples as they
/// are: other tools do not centre them.
HankelFactor uncentred(HankelFactor factor) {
  const Index rest = factor.R.cols() - 1;
  const Eigen::HouseholderQR<Matrix> qr(factor.R.rightCols(rest));
  factor.R.setZero();
  factor.R.bottomRightCorner(rest, rest) =
      qr.matrixQR().topRows(rest).triangularView<Eigen::Upper>();
  return factor;
}

void run(const std::filesystem::path& file, int order, int horizon) {
  const Record record = read_record(file);
  const HankelFactor factor = uncentred(compress(record, record.all(), 2 * Index{horizon}));
  const auto observability = Projection(factor, horizon).observability(Weighting::moesp);
  const auto dynamics = identification::shift_invariant(observability.gamma, factor.outputs, order);
  const nlohmann::ordered_json text = {{"singular_values", to_json(observability.singular_values)},
                                       {"pole_moduli", pole_moduli(dynamics.A)}};
  std::printf("%s\n", text.dump().c_str());
}

}  // namespace

void add_subspace(CLI::App& app) {
  struct Arguments {
    std::filesystem::path file;
    int order = 0, horizon = 0;
  };
  const auto given = std::make_shared<Arguments>();
  CLI::App* mode = app.add_subcommand(
      "subspace",
      "Singular values and poles by MOESP from the samples as they are, for published "
      "figures: neither scaled nor centred");
  mode->add_option("file", given->file, "file of samples")->required();
  mode->add_option("--order", given->order)->required()->check(CLI::PositiveNumber);
  mode->add_option("--horizon", given->horizon)->required()->check(CLI::Range(2, 500));
  mode->callback([given] { run(given->file, given->order, given->horizon); });
}

}  // namespace reident::bench
