// What is left in residuals: their correlation with their own past and with the inputs (METHOD.md,
// section 11, "Residuals"). Products are summed within segments of rows without a gap.
//
// With N rows, of which N(tau) pairs are tau apart, independent series have correlations r(tau) of
// mean 0 and variance P N(tau) / N^2, where P is the sum over k of r_aa(k) r_bb(k). Sums over k end
// where k exceeds five times the sum, after `longest_sum` lags, after a quarter of the rows or with
// the longest segment. The cost is linear in the rows. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// A centred signal over rows, with its autocorrelation remembered once it was asked for.
class Series {
 public:
  static constexpr Index longest_sum = 250;

  /// Centres the values (N). Requires ascending segments that cover them; rows of two segments
  /// are never multiplied.
  Series(Vector values, std::vector<RowRange> segments);

  Index rows() const { return centred_.size(); }
  Index longest_segment() const;
  /// Returns N(lag).
  Index pairs(Index lag) const;
  const Vector& centred() const { return centred_; }
  const std::vector<RowRange>& segments() const { return segments_; }

  /// Returns r(lag), lag >= 0; 0 for a signal that does not move.
  double autocorrelation(Index lag);

 private:
  Vector centred_;
  std::vector<RowRange> segments_;
  double energy_;
  std::vector<double> known_;  // at the lags 0, 1, ...
};

/// r at the lags first_lag, first_lag + 1, ... and what 95 % of independent signals stay within.
struct Correlogram {
  Index first_lag = 0;
  Vector r;
  Vector bound;
};

/// Returns the lags 1 to `lags`, but at most a quarter of the rows and within the longest segment;
/// bounds are those of a white signal.
Correlogram autocorrelogram(Series& series, Index lags);

/// Returns the lags -lags to lags, as far as above. At a positive one the residual follows the
/// input. Requires series of the same rows.
Correlogram cross_correlogram(Series& input, Series& residual, Index lags);

/// Returns P of two series of the same rows: 1 + 2 sum r_aa(k) r_bb(k), at least 1.
double bartlett_factor(Series& a, Series& b);

/// Returns 1 + 2 sum r(k), at least 1: the rows that determine the mean as one independent row
/// does.
double correlated_rows(Series& series);
/// Returns the most of them among the columns (N x p), whose rows are in these segments.
double most_correlated_rows(const Matrix& columns, const std::vector<RowRange>& segments);

/// A correlogram in a few figures.
struct CorrelationSummary {
  Index lags = 0;            // looked at; with 0 of them there is nothing to say
  double largest = 0;        // r where |r| is largest
  Index lag = 0;             // there
  double bound = 0;          // 95 % for this lag alone
  double joint_bound = 0;    // 95 % for the largest of all lags (Z. Sidak, J. ASA 62, 1967)
  double share_outside = 0;  // of the lags; chance gives 0.05

  /// Whether the largest |r| is beyond its joint bound; a value that is not finite is.
  bool significant() const { return !(largest <= joint_bound && -largest <= joint_bound); }
};

/// Returns the figures of a correlogram.
CorrelationSummary summary(const Correlogram& correlogram);

/// Whether a series is white, by one figure for all lags:
///   Q = N (N + 2) sum r(tau)^2 / N(tau)
/// White series of rows that nothing was fitted to stay below the limit, the 95 % quantile of
/// chi-squared of as many degrees as lags, in 95 % of all cases.
struct Portmanteau {
  double statistic = 0;
  double limit = 0;
  bool white() const { return statistic <= limit; }
};

/// Returns Q of the autocorrelogram of the series.
Portmanteau portmanteau(const Series& series, const Correlogram& correlogram);

}  // namespace reident::identification
