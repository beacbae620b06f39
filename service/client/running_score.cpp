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

void RunningScore::clear() {
  rows_ = 0;
  for (Array* sums : {&count_, &mean_, &spread_, &squares_, &errors_}) sums->setZero();
}

void RunningScore::add(const Eigen::Ref<const Vector>& y, const Eigen::Ref<const Vector>& y_hat) {
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

double RunningScore::mrse(identification::Index output) const {
  if (!(count_(output) > 0)) return std::numeric_limits<double>::quiet_NaN();
  // 0/0 is a zero output that was met exactly.
  return errors_(output) > 0 ? 100 * std::sqrt(errors_(output) / squares_(output)) : 0;
}

double RunningScore::mrse() const {
  double sum = 0;
  for (identification::Index q = 0; q < count_.size(); ++q) sum += mrse(q);
  return sum / static_cast<double>(count_.size());
}

identification::Score RunningScore::score() const {
  identification::Score score{Vector(count_.size()), Vector(count_.size()), rows_};
  for (identification::Index q = 0; q < count_.size(); ++q) {
    score.mrse_percent(q) = mrse(q);
    score.fit_percent(q) = spread_(q) > 0 ? 100 * (1 - std::sqrt(errors_(q) / spread_(q)))
                                          : std::numeric_limits<double>::quiet_NaN();
  }
  return score;
}

}  // namespace reident
