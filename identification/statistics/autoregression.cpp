#include "identification/statistics/autoregression.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident::identification {

Autoregression autoregression(Series& series) {
  const Index rows = series.rows();
  const Index most = std::min<Index>({20, rows / 20, series.longest_segment() - 1});
  Autoregression found;
  std::size_t best = 0;
  double variance = 1, least = 0;
  for (Index n = 1; n <= most; ++n) {
    const Vector& a = found.coefficients.back();
    double left = series.autocorrelation(n);
    for (Index i = 0; i < n - 1; ++i) left -= a(i) * series.autocorrelation(n - 1 - i);
    const double k = left / variance;
    variance *= 1 - k * k;
    if (!(variance > 0)) break;
    Vector next(n);
    for (Index i = 0; i < n - 1; ++i) next(i) = a(i) - k * a(n - 2 - i);
    next(n - 1) = k;
    found.coefficients.push_back(std::move(next));
    found.deviation.push_back(std::sqrt(variance));
    const double criterion = double(rows) * std::log(variance) + double(n) * std::log(double(rows));
    if (criterion < least) {
      least = criterion;
      best = static_cast<std::size_t>(n);
    }
  }
  found.coefficients.resize(best + 1);
  found.deviation.resize(best + 1);
  return found;
}

}  // namespace reident::identification
