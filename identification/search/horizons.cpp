#include "identification/search/horizons.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "identification/subspace/hankel.hpp"

namespace reident::identification {
namespace {

constexpr int preferred_horizons[] = {6, 10, 15, 20, 30};

}  // namespace

Index HankelSupply::columns(RowRange rows, int horizon) const {
  const Index found = hankel_columns(segments_within(segments, rows), 2 * Index{horizon});
  return found >= 2 * Index{horizon} * width + 1 ? found : 0;
}

Index HankelSupply::columns(int horizon) const {
  Index least = std::numeric_limits<Index>::max();
  for (const Fold& fold : folds) least = std::min(least, columns(fold.fit, horizon));
  return least;
}

int least_horizon(const IdentifyOptions& options) {
  return std::max(2, options.order.value_or(options.min_order) + 1);
}

int longest_horizon(const IdentifyOptions& options) {
  return options.horizon.value_or(
      std::max(*std::rbegin(preferred_horizons), least_horizon(options)));
}

int largest_order(int horizon, Index p) {
  return static_cast<int>(p) * (horizon - 1);
}

int horizon_of_order(int order, Index p) {
  for (const int horizon : preferred_horizons)
    if (largest_order(horizon, p) >= order) return horizon;
  return *std::rbegin(preferred_horizons);
}

std::vector<int> feasible_horizons(const HankelSupply& supply, const IdentifyOptions& options) {
  const int least = options.horizon.value_or(least_horizon(options));
  const Index columns = supply.columns(least);
  if (columns == 0) return {};
  if (options.horizon) return {least};
  std::vector<int> horizons;
  for (const int horizon : preferred_horizons)
    if (horizon >= least && 2 * supply.columns(horizon) >= columns) horizons.push_back(horizon);
  if (!horizons.empty()) return horizons;
  // Holes all over the rows: what is left need only determine the factor, since it is where the
  // refinement begins.
  for (int horizon = *std::begin(preferred_horizons); horizon > least; --horizon)
    if (supply.columns(horizon) > 0) return {horizon};
  return {least};
}

}  // namespace reident::identification
