// Whether the mean of bounded scores is above a value, decided by betting (METHOD.md, section 19;
// I. Waudby-Smith and A. Ramdas, "Estimating means of bounded random variables by betting", Journal
// of the Royal Statistical Society B 86, 2024). The wealth of one who bets on it rarely grows where
// it is not so, however often it is looked at. Nothing here throws.
#pragma once

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Cycles of a series that show how it varies.
inline constexpr Index cycles_to_measure = 8;

/// Scores in the order of time, each within [-bound, bound], and what was found of them.
struct ScoreSeries {
  Vector scores;
  double bound = 1;
  /// Those of a whole cycle.
  Index cycle = 1;
  /// Least dependence until cycles_to_measure are there, at least 1; 0: the cycle's scores count as
  /// one at first.
  double assumed = 0;
};

/// Someone who bets on a series of scores, that their mean is above a value.
class Bet {
 public:
  explicit Bet(ScoreSeries series);

  const Vector& scores() const { return series_.scores; }

  /// Returns how many scores count as one, at least 1: by how many times the variance of a mean of
  /// the scores exceeds that of as many independent ones, the largest ratio that means of 2, 4, 8
  /// ... scores show.
  double dependence() const { return dependence_; }

  /// Returns the logarithm of the wealth of one who bets that the mean of the scores is above
  /// `mean` in (-bound, bound). Where it is not, the wealth ever exceeds w with a probability of at
  /// most 1 / w. Dependent scores count as 1 / dependence() each. 0 without scores.
  double log_wealth(double mean = 0) const;

  /// Returns the lower end of the confidence sequence: the largest mean against which log_wealth()
  /// exceeds `log_threshold`; -bound where there is none.
  double lower_mean(double log_threshold) const;

 private:
  ScoreSeries series_;
  double dependence_ = 1;
};

}  // namespace reident::identification
