// Whether sensors that a relation binds are right: where the residual of the relation stays away
// from zero (METHOD.md, section 17). A balance of currents at a node is zero but for noise,
// calibration and lags; a faulty sensor moves it. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Ticks at which the relation does not hold, and its residual there, in its unit.
struct Inconsistency {
  TickRange ticks;
  double residual = 0;    // median of r there; of |r|, with the sign of that, where it is a level
  bool is_shift = false;  // within the tolerance, but away from the usual value
};

/// Judges `residual`, whose one output is r (N x 1); rows that follow each other count as
/// neighbours across a gap. Requires finite rows and a positive tolerance. Returns the findings
/// ascending in time; none for fewer than 121 rows. The cost is linear in the rows.
std::vector<Inconsistency> inconsistencies(const Record& residual, double tolerance);

}  // namespace reident::identification
