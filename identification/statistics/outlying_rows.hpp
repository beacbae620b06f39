// Rows of an output that neither the inputs nor the rows around explain: samples that are no
// measurements, and too many or too much alike to be told from pulses of the equipment by
// themselves. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Returns the rows, ascending, at which the values that a model leaves of an output lie off the
/// median of five rows around by eight deviations, as the median of such distances tells them (F.
/// R. Hampel, "The influence curve and its role in robust estimation", Journal of the American
/// Statistical Association 69, 1974). Where nine of ten rows are the median, any other is off. Rows
/// less than two from an end of a segment are not judged. Empty where there are more than a tenth
/// of the rows, or where they hold less than this share of the square of all distances: errors are
/// so then.
std::vector<Index> outlying_rows(const Vector& values, const std::vector<RowRange>& segments,
                                 double least_square_share = 0.5);

}  // namespace reident::identification
