// How far off the static gain of a model may be (METHOD.md, section 6, "Gains at rest"). Nothing
// here throws.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the half width of 95 % intervals of static_gain() (p x m, in its units), where all of A,
/// B, C, y0, the initial states and, with `direct`, D were fitted to the outputs of `rows`; of the
/// last of them where these are many. 0 for an input that does not move. Absent where the model has
/// no static gain, is of an order above 20, or has as many parameters as there are outputs.
std::optional<Matrix> gain_uncertainty(const StateSpaceModel& model, bool direct,
                                       const Record& record, RowRange rows);

}  // namespace reident::identification
