#include "service/client/running_score.hpp"

#include <cmath>
#include <limits>

namespace reident {

RunningScore::RunningScore(identification::Index outputs)
    : count_(Array::Zero(outputs)),
      mean_(Array::Zero(outputs)),
      spread_(Array::Zero(outputs)),
      squares_(Array::Zero(outputs)),
      errors_(Array::Zero(outputs)) {}

void RunningScore::add(const Vector& y, const Vector& y_hat) {
  bool any = false;
  for (identification::Index q = 0; q < y.size(); ++q) {
    if (!std::isfinite(y(q)) || !std::isfinite(y_hat(q))) continue;
    any = true;
    count_(q) += 1;
    const double distance = y(q) - mean_(q);
    mean_(q) += distance / count_(q);
    spread_(q) += distance * (y(q) - mean_(q));
    squares_(q) += y(q) * y(q);
    errors_(q) += (y(q) - y_hat(q)) * (y(q) - y_hat(q));
  }
  if (any) ++rows_;
}

identification::Score RunningScore::score() const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  identification::Score score{Vector(count_.size()), Vector(count_.size()), rows_};
  for (identification::Index q = 0; q < count_.size(); ++q) {
    // 0/0 is a zero output that was met exactly.
    const double relative = errors_(q) > 0 ? std::sqrt(errors_(q) / squares_(q)) : 0;
    score.mrse_percent(q) = count_(q) > 0 ? 100 * relative : nan;
    score.fit_percent(q) = spread_(q) > 0 ? 100 * (1 - std::sqrt(errors_(q) / spread_(q))) : nan;
  }
  return score;
}

}  // namespace reident
