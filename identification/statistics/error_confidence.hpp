// How sure an error figure is: an interval for it, and what it is on parts of the rows.
//
// The interval is that of the circular block bootstrap (D. N. Politis, J. P. Romano, "A circular
// block-resampling procedure for stationary data", in "Exploring the Limits of Bootstrap", Wiley,
// 1992), the moving-block bootstrap of H. R. Kuensch (Annals of Statistics 17(3), 1989) in which
// each row has the same weight: blocks of consecutive rows are drawn until the rows are as many as
// there were, and the error is computed of them. A block only adds up squares, so that it may span
// a gap.
//
// Length of a block. What the error's logarithm owes to row t is, to first order,
//   psi[t] = e[t]^2 / mean(e^2) - y[t]^2 / mean(y^2),
// and S = 1 + 2 sum of its autocorrelation is the number of rows that count as one. The estimate of
// a variance has the least mean square error with blocks of
//   (3/2)^(1/3) ((S^2 - 1) / (2 S))^(2/3) N^(1/3)
// rows where the correlation is of first order (E. Carlstein, Annals of Statistics 14(3), 1986).
// Blocks are three times as long, since an interval suffers more from a variance too small than
// from one too scattered; that of the output with the longest is taken. They have at least N / 250
// rows, which bounds the work, and at most N / 10, since fewer blocks say nothing of how they
// differ.
//
// Few blocks make percentiles too narrow; they are widened as Student's t is against the normal
// distribution (T. C. Hesterberg, "What teachers should know about the bootstrap", The American
// Statistician 69(4), 2015, section 4: the expanded percentile interval).
//
// The cost is that of correlation.hpp and 1000 replicates of at most 250 blocks.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Fewer rows, or fewer blocks of rows that are as good as independent, give no interval.
inline constexpr Index least_rows = 50;
inline constexpr Index least_blocks = 10;

/// The block length of least mean square error for the variance of a mean over `rows` rows, of
/// which `correlated_rows` count as one.
double optimal_block_rows(double correlated_rows, Index rows);

/// 95 % intervals of the MRSE in percent.
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

/// y and y_hat are N x p; `stretches` cover the rows, without a gap in each. Deterministic. Absent
/// for fewer than 50 rows, an output of zeros, a run without error or one that is not finite.
std::optional<ErrorInterval> error_interval(const Matrix& y, const Matrix& y_hat,
                                            const std::vector<RowRange>& stretches);

/// The error of equal parts of the rows, one entry an output: the root mean square error of a part
/// in percent of the root mean square of the output over all rows, so that a part in which the
/// output rests at zero has one too. The mean square of the parts is the square of the MRSE.
struct ErrorSpread {
  Index parts = 0;
  Vector smallest, median, largest;
};

/// Ten parts, fewer where one would have less than 10 rows; N >= 1. +inf for an output of zeros.
ErrorSpread error_spread(const Matrix& y, const Matrix& y_hat);

}  // namespace reident::identification
