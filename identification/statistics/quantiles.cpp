#include "identification/statistics/quantiles.hpp"

#include <cmath>
#include <numbers>

namespace reident::identification {

double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1 - p);
  // P(Z <= -x) <= exp(-x^2 / 2) / 2 gives a start below the root; the function is convex there, so
  // that Newton's first step passes the root and the others come back to it.
  double z = -std::sqrt(-2 * std::log(2 * p));
  for (int i = 0; i < 50; ++i) {
    const double excess = 0.5 * std::erfc(-z / std::numbers::sqrt2) - p;
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    const double step = excess / density;
    z -= step;
    if (std::abs(step) < 1e-14) break;
  }
  return z;
}

/// E. B. Wilson, M. M. Hilferty, PNAS 17(12), 1931.
double chi_squared_quantile(double p, double degrees) {
  const double spread = 2 / (9 * degrees);
  const double root = 1 - spread + normal_quantile(p) * std::sqrt(spread);
  return degrees * root * root * root;
}

namespace {

/// P(chi-squared > limit), from that of one or two degrees on; all terms are positive.
double chance_above(double limit, int degrees) {
  const double half = limit / 2;
  double d = degrees % 2 == 0 ? 2 : 1;
  double chance = d == 2 ? std::exp(-half) : std::erfc(std::sqrt(half));
  for (; d < degrees; d += 2)
    chance += std::exp(d / 2 * std::log(half) - half - std::lgamma(d / 2 + 1));
  return chance;
}

}  // namespace

double chi_squared_limit(double probability, int degrees) {
  double below = 0, above = degrees;
  while (chance_above(above, degrees) > probability) above *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (below + above) / 2;
    (chance_above(middle, degrees) > probability ? below : above) = middle;
  }
  return above;
}

/// R. A. Fisher, E. A. Cornish, Technometrics 2(2), 1960.
double student_quantile(double p, double degrees) {
  const double z = normal_quantile(p), z2 = z * z;
  const double first = (z2 + 1) * z / 4;
  const double second = ((5 * z2 + 16) * z2 + 3) * z / 96;
  const double third = (((3 * z2 + 19) * z2 + 17) * z2 - 15) * z / 384;
  return z + (first + (second + third / degrees) / degrees) / degrees;
}

}  // namespace reident::identification
