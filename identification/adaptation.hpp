// A known model made to fit new samples, its poles kept.
//
// Where equipment ages or a part of it fails, its gains move more than its time constants, and
// these take longer to tell from samples than the gains. With A and C kept, what is left of the
// output y - y_known is linear in the changes of B, D and y0 and in the initial states:
//
//   y[k] - y_known[k] = C A^k dx0 + sum_{j<k} C A^(k-1-j) dB u[j] + dD u[k] + dy0
//
// The least squares solution is the one of least norm, in inputs of mean 0 and deviation 1: what
// the samples do not determine stays as it was, and the gain of an input that does not move.
#pragma once

#include "identification/record.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

/// `known` with B, D and y0 moved to fit its simulated output to the rows. Requires a stable,
/// well-formed model of the record's channels and period, and finite rows, at least one.
StateSpaceModel adapted(const StateSpaceModel& known, const Record& record, RowRange rows);

}  // namespace reident::identification
