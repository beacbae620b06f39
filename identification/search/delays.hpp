// Inputs that act only some samples later.
//
// A state-space model of moderate order cannot hold a long pure delay, and fits it with poles that
// mean nothing. Here the model is identified from inputs that were shifted, and the shift then
// becomes states of the model, so that what comes out is a plain model of the inputs as they are:
//   x+ = A x + B v,  y = C x + D v,  v_i[k] = u_i[k - d_i]
// with the d_i last values of u_i - u0_i as states, the latest first.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// The rows with input i replaced by what it was delays[i] samples before (0 <= delays[i] <=
/// left_out). The first `left_out` rows of each segment are left out.
Record delayed(const Record& record, RowRange rows, const std::vector<int>& delays, int left_out);

/// The model of the inputs as they are, from one of the delayed inputs. The states of the delays
/// come last; K does not correct them.
StateSpaceModel with_delay_states(const StateSpaceModel& model, const std::vector<int>& delays);

}  // namespace reident::identification
