// Whether a model's errors have grown for good: a one-sided cumulative sum.
//
// With z = (log e - mean) / deviation of the error of each block of rows,
//
//   S <- max(0, S + min(z, 3) - a),   a change where S > h
//
// (E. S. Page, "Continuous inspection schemes", Biometrika 41, 1954). No single block, however bad,
// adds more than 3 - a, so that it takes several in a row: h is 8. The reference is estimated from
// n blocks that the model was validated on. Its deviation is taken at the upper end of the 80 %
// interval that chi-squared gives, and the allowance a = 0.5 + 1 / sqrt(n) forgives a mean that is
// one of its standard errors too low. With the reference known, a = 0.5 and independent normal z,
// the mean number of blocks between false alarms is
//
//   (exp(2 a b) - 2 a b - 1) / (2 a^2) = 19,000,   b = h + 1.166
//
// (D. Siegmund, "Sequential Analysis", Springer, 1985). METHOD.md has the rates and delays that
// were measured with estimated references.
#pragma once

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

class ChangeDetector {
 public:
  static constexpr Index least_blocks = 8;

  /// Logarithms of the errors of at least `least_blocks` blocks in which nothing had changed.
  explicit ChangeDetector(const Vector& reference);

  /// Takes the logarithm of the next block's error in. True where a change is found; the sum then
  /// begins anew.
  bool add(double log_error);

  double statistic() const { return sum_; }
  double mean() const { return mean_; }

 private:
  double mean_;
  double deviation_;
  double allowance_;
  double sum_ = 0;
};

}  // namespace reident::identification
