// Which horizons the rows can feed (METHOD.md, section 7, "Stages"). Private to this
// folder. Options have no mistakes; nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/search/folds.hpp"
#include "identification/search/identify.hpp"

namespace reident::identification {

/// What the rows have to feed a Hankel matrix of `width` = m + p channels.
struct HankelSupply {
  const std::vector<Segment>& segments;
  Index width;
  const std::vector<Fold>& folds;

  /// Returns the columns of the Hankel matrix of 2 * horizon block rows over the rows; 0 where they
  /// do not determine its factor.
  Index columns(RowRange rows, int horizon) const;
  /// Returns the columns of the poorest fold.
  Index columns(int horizon) const;
};

/// Returns the least horizon that can carry the order asked for.
int least_horizon(const IdentifyOptions& options);

/// Returns the longest horizon that these options may lead to.
int longest_horizon(const IdentifyOptions& options);

/// Returns the largest order that a horizon can carry with p outputs.
int largest_order(int horizon, Index p);

/// Returns the least horizon of those that are tried, 6 to 30, that carries the order with p
/// outputs; the longest where none does.
int horizon_of_order(int order, Index p);

/// Returns the horizons of {6, 10, 15, 20, 30} that the rows can feed, ascending. A longer one must
/// leave at least half of the columns that the shortest one has, since gaps cost columns. Where
/// none does, the longest up to 6 that they can feed at all; else the least.
std::vector<int> feasible_horizons(const HankelSupply& supply, const IdentifyOptions& options);

}  // namespace reident::identification
