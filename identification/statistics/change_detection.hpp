// Whether a model's errors have grown for good: a one-sided cumulative sum (METHOD.md, section 16;
// E. S. Page, "Continuous inspection schemes", Biometrika 41, 1954). No single block, however bad,
// is enough: it takes several in a row. Nothing here throws.
#pragma once

#include <utility>
#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Judges the errors of blocks of rows against those of reference blocks.
class ChangeDetector {
 public:
  /// Blocks that the reference needs.
  static constexpr Index least_blocks = 8;

  /// Takes the logarithms of the errors of the reference blocks, in which nothing had changed.
  /// Requires at least `least_blocks` finite ones.
  explicit ChangeDetector(const Vector& reference);
  /// Takes what a regression with so many unknowns leaves of these logarithms. A part of each
  /// block, its weight in [0, 1], says something. Requires weights whose sum is at least
  /// `least_blocks` and above the unknowns.
  ChangeDetector(const Vector& reference, const Vector& weights, Index unknowns);

  /// Takes the logarithm of the next block's error in, and its weight. Returns whether a change is
  /// found; the sum then begins again at 0.
  bool add(double log_error, double weight = 1);

  /// Return the sum, a change above 8, and the mean of the reference.
  double statistic() const { return sum_; }
  double mean() const { return mean_; }

  /// Behind a change: with how many of the last blocks it may have begun, at the most.
  Index blocks_since() const;

 private:
  double mean_;
  double deviation_;
  double allowance_;
  double sum_ = 0;
  std::vector<std::pair<double, double>> risen_;  // z, at most 6, and weight: since the sum was 0
};

}  // namespace reident::identification
