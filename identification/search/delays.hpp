// Inputs that act only some samples later: the model is identified from shifted inputs,
// v_i[k] = u_i[k - d_i], and the d_i last values of u_i - u0_i become states, the latest first
// (METHOD.md, section 6, "Delays"). Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the rows with input i replaced by what it was delays[i] samples before, without the
/// first `left_out` rows of each segment. Requires m delays from 0 to `left_out`.
Record delayed(const Record& record, RowRange rows, const std::vector<int>& delays, int left_out);

/// Returns the model of the inputs as they are. Delays' states come last; K does not correct them.
StateSpaceModel with_delay_states(const StateSpaceModel& model, const std::vector<int>& delays);

/// Returns the model that with_delay_states() was given.
StateSpaceModel without_delay_states(const StateSpaceModel& model, const std::vector<int>& delays);

}  // namespace reident::identification
