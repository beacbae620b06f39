// The run of a model over one segment, which free runs and estimates of states are made of.
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Runs the record's inputs through the model from the state `x` (n) at the segment's first row.
/// Writes the outputs into the rows of `y_hat` (p columns) from the row `out` on and returns the
/// state (n) at the tick behind the last row. Values of an unstable model may overflow. Requires a
/// well-formed model of the record's channels. Nothing throws.
Vector run_segment(const StateSpaceModel& model, const Record& record, const Segment& segment,
                   Vector x, Matrix& y_hat, Index out);

}  // namespace reident::identification
