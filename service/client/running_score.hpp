// Errors of a run that has no end: the scores of identification/simulation/scores.hpp, sample by
// sample.
#pragma once

#include "identification/simulation/scores.hpp"

namespace reident {

/// One thread at a time. Its memory does not grow with the samples.
class RunningScore {
 public:
  using Vector = identification::Vector;

  /// For p >= 1 outputs.
  explicit RunningScore(identification::Index outputs);

  /// Begins again.
  void clear();
  /// Adds the measured and the simulated outputs (p each) at one tick. An output counts where both
  /// are finite. Allocates nothing.
  void add(const Eigen::Ref<const Vector>& y, const Eigen::Ref<const Vector>& y_hat);
  /// Returns the errors [%] of each output. NaN before the first sample of an output, and for a fit
  /// before two different values of it.
  identification::Score score() const;
  /// score().mrse(), the mean over the outputs, without allocating.
  double mrse() const;
  /// Ticks at which any output counted.
  identification::Index rows() const { return rows_; }

 private:
  using Array = Eigen::ArrayXd;
  double mrse(identification::Index output) const;

  identification::Index rows_ = 0;
  Array count_, mean_, spread_;  // spread: sum of squared distances from the mean (Welford)
  Array squares_, errors_;       // sums of y^2 and (y - y_hat)^2
};

}  // namespace reident
