// The state at the beginning of a run, estimated from the outputs (METHOD.md, section 6, "Initial
// state"). Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_observation.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the rows that an estimate needs: three times the order, at least one.
Index initial_rows(const StateSpaceModel& model);

/// Returns the least-squares state (n) at the first row of `segments`, of least norm where the
/// outputs do not determine it. Each output is weighed by its error, so that units make no
/// difference. The segments are of the record and ascend; `rows`, such as
/// `state_rows`, are the rows to estimate from. Holes that a run bridges are gone through with
/// their uncertainty; rows behind a longer one, or further than 2 `rows` ticks away, are not used.
/// Zero without rows, and where an unstable model overflows within them.
Vector estimate_initial_state(const StateSpaceModel& model, const Record& record,
                              const std::vector<Segment>& segments, Index rows);

}  // namespace reident::identification
