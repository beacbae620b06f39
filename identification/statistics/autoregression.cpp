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

Vector burg_coefficients(const Vector& values, const std::vector<RowRange>& segments) {
  const Index most = std::min<Index>(20, values.size() / 20);
  Vector forwards = values.array() - values.mean(), backwards = forwards, past(0);
  for (Index n = 1; n <= most; ++n) {
    double products = 0, squares = 0;
    for (const RowRange& segment : segments)
      for (Index t = segment.begin + n; t < segment.end; ++t) {
        products += forwards(t) * backwards(t - 1);
        squares += forwards(t) * forwards(t) + backwards(t - 1) * backwards(t - 1);
      }
    if (!(squares > 0)) break;
    const double k = 2 * products / squares;
    for (const RowRange& segment : segments)
      for (Index t = segment.end - 1; t >= segment.begin + n; --t) {
        const double forward = forwards(t);
        forwards(t) -= k * backwards(t - 1);
        backwards(t) = backwards(t - 1) - k * forward;
      }
    Vector next(n);
    for (Index i = 0; i < n - 1; ++i) next(i) = past(i) - k * past(n - 2 - i);
    next(n - 1) = k;
    past = std::move(next);
  }
  return past;
}

Innovations innovations_of(const Vector& values, const Vector& coefficients,
                           const std::vector<RowRange>& segments) {
  Innovations found;
  for (const RowRange& segment : segments)
    for (Index t = segment.begin + coefficients.size(); t < segment.end; ++t, ++found.rows) {
      double left = values(t);
      for (Index i = 0; i < coefficients.size(); ++i) left -= coefficients(i) * values(t - 1 - i);
      found.squares += left * left;
    }
  return found;
}

}  // namespace reident::identification
