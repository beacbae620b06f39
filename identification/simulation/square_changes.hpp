// How much signals change from one row to the next: what is not known of an input in a hole, and
// what of an error is noise (METHOD.md, sections 6 and 15). Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Squares of the changes from row to row, one entry a signal, in the square of its unit.
struct SquareChanges {
  Vector mean;
  Vector usual;  // the median, over that of the square of a unit normal: without rare steps
};

/// Returns the changes of signals (N x m) within the segments of their rows; 0 where no two rows
/// of a segment follow each other.
SquareChanges square_changes(const Matrix& signals, const std::vector<RowRange>& segments);
/// Returns those of the record's inputs.
SquareChanges square_changes(const Record& record);

}  // namespace reident::identification
