// What is left in residuals: their correlation with their own past and with the inputs.
//
// Series are centred, and products are summed within stretches of rows without a gap. With N rows,
// of which N(tau) pairs lie tau apart,
//
//   r_ab(tau) = sum a[t - tau] b[t] / sqrt(sum a^2 sum b^2)
//
// has for independent a and b nearly a normal distribution of mean 0 and variance
//
//   P N(tau) / N^2,   P = sum over k of r_aa(k) r_bb(k)
//
// (M. S. Bartlett; L. Ljung, "System Identification", 2nd edition, Prentice Hall, 1999, section
// 16.6). P is 1 where either is white. Sums over k end where k exceeds five times the sum (the
// window of A. Sokal, "Monte Carlo methods in statistical mechanics", 1996), or after `longest_sum`
// lags or a tenth of the rows, and are not taken below 1. The cost is linear in the rows: at most
// `longest_sum` products a row and series.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// A signal over rows, with its autocorrelation remembered once it was asked for.
class Series {
 public:
  static constexpr Index longest_sum = 250;

  /// `stretches` are ascending and cover the values; rows of two stretches are never multiplied.
  Series(Vector values, std::vector<RowRange> stretches);

  Index rows() const { return centred_.size(); }
  Index longest_stretch() const;
  Index pairs(Index lag) const;
  const Vector& centred() const { return centred_; }
  const std::vector<RowRange>& stretches() const { return stretches_; }

  /// 0 for a signal that does not move.
  double autocorrelation(Index lag);

 private:
  Vector centred_;
  std::vector<RowRange> stretches_;
  double energy_;
  std::vector<double> known_;  // at the lags 0, 1, ...
};

/// r at the lags first_lag, first_lag + 1, ... and what 95 % of independent signals stay within.
struct Correlogram {
  Index first_lag = 0;
  Vector r;
  Vector bound;
};

/// At the lags 1 to `lags`, but at most a quarter of the rows and within the longest stretch;
/// bounds for a white signal.
Correlogram autocorrelogram(Series& series, Index lags);

/// At the lags -lags to lags, as far as above. At a positive one the residual follows the input.
Correlogram cross_correlogram(Series& input, Series& residual, Index lags);

/// P of two series of the same rows: 1 + 2 sum r_aa(k) r_bb(k), at least 1.
double bartlett_factor(Series& a, Series& b);

/// 1 + 2 sum r(k), at least 1: the rows that say as much of the mean as one independent row.
double correlated_rows(Series& series);

/// A correlogram in a few figures.
struct CorrelationSummary {
  Index lags = 0;            // looked at; with 0 of them there is nothing to say
  double largest = 0;        // r where |r| is largest
  Index lag = 0;             // there
  double bound = 0;          // 95 % for this lag alone
  double joint_bound = 0;    // 95 % for the largest of all lags (Z. Sidak, J. ASA 62, 1967)
  double share_outside = 0;  // of the lags; chance gives 0.05

  bool significant() const { return !(largest <= joint_bound && -largest <= joint_bound); }
};

CorrelationSummary summary(const Correlogram& correlogram);

/// Whether a series is white, by one figure for all lags:
///   Q = N (N + 2) sum r(tau)^2 / N(tau)
/// (G. M. Ljung, G. E. P. Box, Biometrika 65(2), 1978). White series of rows that nothing was
/// fitted to stay below the 95 % quantile of chi-squared of as many degrees as lags. On the rows
/// that the model was fitted to, Q is a little smaller than that.
struct Portmanteau {
  double statistic = 0;
  double limit = 0;
  bool white() const { return statistic <= limit; }
};

Portmanteau portmanteau(const Series& series, const Correlogram& correlogram);

}  // namespace reident::identification
