#include "identification/search/mode_elimination.hpp"

#include <limits>
#include <utility>

#include "identification/numerics/schur_blocks.hpp"

namespace reident::identification {
namespace {

Dynamics without(SchurBlocks blocks, Index block, const Matrix& C) {
  for (; block + 1 < blocks.count(); ++block) blocks.swap_with_next(block);
  const Index rows = blocks.first_row(blocks.count() - 1);
  return {blocks.T().topLeftCorner(rows, rows), C * blocks.Q().leftCols(rows)};
}

}  // namespace

std::vector<FewerModes> fewer_modes(Dynamics dynamics, bool direct, const Record& record,
                                    RowRange rows, Index least_order) {
  std::vector<FewerModes> found;
  while (dynamics.A.rows() > least_order) {
    const SchurBlocks blocks(dynamics.A);
    FewerModes best{{}, std::numeric_limits<double>::infinity()};
    for (Index block = 0; block < blocks.count(); ++block) {
      if (dynamics.A.rows() - blocks.size(block) < least_order) continue;
      Dynamics left = without(blocks, block, dynamics.C);
      const double error = fit_response(left.A, left.C, direct, record, rows, Accuracy::fast).error;
      if (error < best.error) best = {std::move(left), error};
    }
    if (best.dynamics.A.rows() == 0) break;
    dynamics = best.dynamics;
    found.push_back(std::move(best));
  }
  return found;
}

Response refined(const Dynamics& dynamics, const Recipe& recipe, const Record& record,
                 RowRange rows) {
  const auto refine = [&](const Dynamics& from) {
    return refine_response(from.A, from.C, recipe.direct, record, rows, recipe.refinement_steps,
                           recipe.least_rate);
  };
  Response result = refine(dynamics);
  if (recipe.eliminated_from > 0) {
    const auto fewer =
        fewer_modes({result.model.A, result.model.C}, recipe.direct, record, rows, recipe.order);
    if (!fewer.empty()) result = refine(fewer.back().dynamics);
  }
  if (!recipe.weighted) return result;
  return refine_whitened(result, recipe.direct, record, rows, recipe.refinement_steps,
                         deviations_of(result, record, rows), recipe.least_rate);
}

}  // namespace reident::identification
