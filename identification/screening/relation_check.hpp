// Whether sensors that a relation binds tell the truth: where its residual stays away from zero.
//
// The residual r of a balance (a sum of currents at a node, two measurements of one voltage) is
// zero but for noise, calibration and the lag of its sensors; a sensor that lies moves it (E. Y.
// Chow, A. S. Willsky, "Analytical redundancy and the design of robust failure detection systems",
// IEEE Transactions on Automatic Control 29(7), 1984). What is looked at is the median over
// a stretch of rows: neither spikes nor the lag of a sensor at a load step move it as long as they
// take less than half of the stretch, and a bias moves it by its size.
//
//   level   median of |r| over 121 rows > tolerance: a bias, or noise that is larger
//   shift   |median of r over 1201 rows - usual| > tolerance / 2, usual the median over all rows
//   within
//                                                              the tolerance
//
// A shift is what a bias below the tolerance looks like that began or ended within the rows; where
// it holds for most of them it is the usual value, and what was there before is out of the usual:
// the rows on one side are then left out, not mixed. Both are decided by counting: the median lies
// beyond a level where more than half of the rows do. The cost is linear in the rows.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

struct Inconsistency {
  TickRange ticks;
  double residual = 0;    // median of r there; of |r|, with the sign of that, where it is a level
  bool is_shift = false;  // within the tolerance, but away from the usual value
};

/// `residual` has r as its one output (N x 1); its segments may be of any length, and rows that
/// follow each other count as neighbours across a gap. tolerance > 0. Ascending in time; of fewer
/// than 121 rows none.
std::vector<Inconsistency> inconsistencies(const Record& residual, double tolerance);

}  // namespace reident::identification
