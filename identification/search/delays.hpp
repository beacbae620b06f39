// Inputs that act only some samples later: the model is identified from shifted inputs,
// v_i[k] = u_i[k - d_i], and the d_i last values of u_i - u0_i become states, the latest first
// (METHOD.md, section 6, "Delays"). Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the segments with the most rows that follow each other by holes that a run goes through
/// (is_bridged()), of several such ones the last; empty where there are no rows.
std::vector<Segment> longest_run(const Record& record, RowRange rows);

/// Returns the last `most` ticks of such a run, or all, as a record without holes: channels have a
/// straight line through them.
Record last_ticks(const Record& record, const std::vector<Segment>& run, Index most);

/// Returns the rows with input i replaced by what it was delays[i] samples before, a straight line
/// in holes that a run goes through. Left out are the first `left_out` ticks of `rows` and behind
/// each longer hole. Requires m delays from 0 to `left_out`.
Record delayed(const Record& record, RowRange rows, const std::vector<int>& delays, int left_out);

/// Returns the rows with such inputs, the longest delay left out. Those of which an input is in a
/// hole are left out too, where they are at most an eighth. Requires a delay for each input, and
/// one at least.
Record delayed_to_identify(const Record& record, RowRange rows, const std::vector<int>& delays);

/// Returns the model of the inputs as they are. Delays' states come last; K does not correct them.
StateSpaceModel with_delay_states(const StateSpaceModel& model, const std::vector<int>& delays);

/// Returns the model that with_delay_states() was given.
StateSpaceModel without_delay_states(const StateSpaceModel& model, const std::vector<int>& delays);

}  // namespace reident::identification
