#include "tests/trust/intervals.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace reident::trust {
namespace {

constexpr double error_probability = 0.05;

/// Of at most `count` instances in `all`.
double probability(int count, int all, double p) {
  double sum = 0;
  for (int k = 0; k <= count; ++k)
    sum += std::exp(std::lgamma(all + 1.0) - std::lgamma(k + 1.0) - std::lgamma(all - k + 1.0) +
                    k * std::log(p) + (all - k) * std::log1p(-p));
  return sum;
}

}  // namespace

double upper_bound(int count, int all) {
  if (count >= all) return 1;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (probability(count, all, middle) > error_probability ? low : high) = middle;
  }
  return high;
}

std::pair<double, double> interval(
    std::size_t scenarios, const std::function<double(const std::vector<std::size_t>&)>& figure) {
  constexpr int resamples = 2000;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> place(0, std::max<std::size_t>(scenarios, 1) - 1);
  std::vector<double> figures;
  for (int i = 0; i < resamples; ++i) {
    std::vector<std::size_t> drawn(scenarios);
    for (std::size_t& one : drawn) one = place(random);
    figures.push_back(figure(drawn));
  }
  std::sort(figures.begin(), figures.end());
  const auto at = [&figures](double share) {
    return figures[static_cast<std::size_t>(share * static_cast<double>(figures.size() - 1))];
  };
  return {at(error_probability / 2), at(1 - error_probability / 2)};
}

}  // namespace reident::trust
