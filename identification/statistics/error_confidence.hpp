// How certain an error figure is: an interval for it, and what it is on parts of the rows
// (METHOD.md, section 11, "The error figure"). y and y_hat are N x p. Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// 95 % intervals of the MRSE in percent, by the circular block bootstrap.
struct ErrorInterval {
  Vector low, high;     // p, one an output
  double mean_low = 0;  // of the mean over the outputs
  double mean_high = 0;
  Index block_rows = 0;
  Index replicates = 0;
  /// The errors are correlated over so many rows that a tenth of all is a short block: the interval
  /// is too narrow.
  bool too_few_rows = false;
};

/// Returns the intervals for the run y_hat. `segments` cover the rows, without a gap in each.
/// Absent for fewer than 50 rows, an output of zeros, a run without error in an output or one that
/// is not finite. The seed is fixed: equal samples have equal intervals.
std::optional<ErrorInterval> error_interval(const Matrix& y, const Matrix& y_hat,
                                            const std::vector<RowRange>& segments);

/// The error of equal parts of the rows, one entry an output (p): the root mean square error of a
/// part in percent of the root mean square of the output over all rows. So a part in which the
/// output rests at zero has one too, and the mean square of the parts is the square of the MRSE.
struct ErrorSpread {
  Index parts = 0;
  Vector smallest, median, largest;
};

/// Returns the spread over ten parts, fewer where one would have less than 10 rows. Requires N
/// >= 1. +inf for an output of zeros with an error.
ErrorSpread error_spread(const Matrix& y, const Matrix& y_hat);

}  // namespace reident::identification
