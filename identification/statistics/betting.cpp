#include "identification/statistics/betting.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace reident::identification {
namespace {

/// Shares of the largest bet. The wealth is divided among them in proportion to these.
constexpr std::array bets = {1.0, 0.5, 0.25, 0.125, 0.0625};
/// Means of so many scores show nothing where there are fewer of them.
constexpr Index least_means = 6;
/// Dependence is taken for that of one cycle at first, and as measured behind so many cycles.
constexpr Index cycles_to_measure = 8;
/// Scores that differ by less, over their bound, are equal but for rounding.
constexpr double rounding = 1e-9;

double variance(const Vector& values) {
  return (values.array() - values.mean()).square().sum() / double(values.size() - 1);
}

/// Means of `length` scores each, of the newest ones.
Vector means(const Vector& scores, Index length) {
  const Index count = scores.size() / length;
  const auto newest = scores.tail(count * length);
  return newest.reshaped(length, count).colwise().mean().transpose();
}

}  // namespace

double dependence(const ScoreSeries& series) {
  const Index n = series.scores.size();
  const double measured = std::min(1.0, double(n) / double(cycles_to_measure * series.cycle));
  const double assumed = series.assumed > 0 ? series.assumed : double(series.cycle);
  double largest = measured + (1 - measured) * assumed;
  if (n < 2) return largest;
  const double of_one = variance(series.scores);
  if (!(of_one > rounding * rounding * series.bound * series.bound)) return largest;
  for (Index length = 2; n / length >= least_means; length *= 2) {
    const Vector together = means(series.scores, length);
    // By a standard deviation more: the ratio of so few means is uncertain.
    const double uncertain = 1 + std::sqrt(2.0 / double(together.size() - 1));
    largest = std::max(largest, double(length) * variance(together) / of_one * uncertain);
  }
  return largest;
}

double log_wealth(const ScoreSeries& series, double dependence, double mean) {
  assert(std::abs(mean) < series.bound);
  std::array<double, bets.size()> logs{};
  for (std::size_t i = 0; i < bets.size(); ++i) {
    double sum = 0;
    for (const double score : series.scores)
      sum += std::log1p(std::max(-1.0, bets[i] * (score - mean) / (series.bound + mean)));
    logs[i] = sum / dependence;
  }
  const double largest = *std::max_element(logs.begin(), logs.end());
  if (!std::isfinite(largest)) return largest;
  double wealth = 0, all = 0;
  for (std::size_t i = 0; i < bets.size(); ++i) {
    wealth += bets[i] * std::exp(logs[i] - largest);
    all += bets[i];
  }
  return largest + std::log(wealth / all);
}

double lower_mean(const ScoreSeries& series, double dependence, double log_threshold) {
  double low = -series.bound, high = series.scores.size() > 0 ? series.scores.mean() : low;
  constexpr int halvings = 40;
  for (int i = 0; i < halvings && low < high; ++i) {
    const double middle = (low + high) / 2;
    if (!(middle > -series.bound)) break;
    (log_wealth(series, dependence, middle) > log_threshold ? low : high) = middle;
  }
  return low;
}

}  // namespace reident::identification
