// A known model made to fit new samples, its A and C kept (METHOD.md, section 18). Nothing throws.
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// What the model was identified from. From these rows, it moves to the least squares solution and
/// loses its gains for inputs' components that are noise; an input without effect stays so. From
/// others, it keeps these gains and moves as far as the rows show with confidence (fit_change() of
/// output_error_fit.hpp).
enum class KnownFrom { these_rows, other_rows };

/// Returns `known` with other B, D and y0. Requires a stable, well-formed model of the record's
/// channels and period, and finite rows, at least one.
StateSpaceModel adapted(const StateSpaceModel& known, const Record& record, RowRange rows,
                        KnownFrom from);

}  // namespace reident::identification
