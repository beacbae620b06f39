// Errors of a run that has no end: the scores of identification/simulation/scores.hpp, sample by
// sample.
#pragma once

#include "identification/simulation/scores.hpp"

namespace reident {

class RunningScore {
 public:
  using Vector = identification::Vector;

  explicit RunningScore(identification::Index outputs);

  /// Begins again.
  void clear();
  /// The measured and the simulated outputs at one tick. Those that are not finite are left out.
  void add(const Eigen::Ref<const Vector>& y, const Eigen::Ref<const Vector>& y_hat);
  /// NaN before the first sample of an output, and for a fit before two different values of it.
  identification::Score score() const;
  /// score().mrse() without allocating.
  double mrse() const;
  identification::Index rows() const { return rows_; }

 private:
  using Array = Eigen::ArrayXd;
  double mrse(identification::Index output) const;

  identification::Index rows_ = 0;
  Array count_, mean_, spread_;  // spread: sum of squared distances from the mean (Welford)
  Array squares_, errors_;       // sums of y^2 and (y - y_hat)^2
};

}  // namespace reident
