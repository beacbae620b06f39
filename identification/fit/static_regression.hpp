// The model without dynamics: what a straight line through the samples gives. It is the standard
// that a dynamic model has to meet.
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the model of order 0, y = y0 + D (u - u0), by least squares over the rows; u0 and y0 are
/// the means. Of inputs that follow from one another the solution of least norm is taken, in units
/// of their deviations. Requires a row; throws nothing.
StateSpaceModel static_regression(const Record& record, RowRange rows);

}  // namespace reident::identification
