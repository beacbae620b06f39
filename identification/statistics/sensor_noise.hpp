// What of a run's errors is noise of the sensors (METHOD.md, section 15). Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Returns the mean squared error that the noise of the sensors alone would give a run, in the
/// square of the output's unit (p): that of the usual change of its errors from row to row. Where
/// an output's samples are held, new ones count. Requires finite y and run (N x p), N >= 1, and
/// segments that cover the rows.
Vector noise_squares(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments);

}  // namespace reident::identification
