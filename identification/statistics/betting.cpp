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
/// Scores that differ by less, over their bound, are equal but for rounding.
constexpr double rounding = 1e-9;

double variance(const Vector& values) {
  return (values.array() - values.mean()).square().sum() / double(values.size() - 1);
}

/// Variance of the mean of `length` successive scores, from all such means: those that overlap too,
/// so that it does not depend on where the first one begins. The scores' own mean is taken for the
/// true one, which the last factor corrects.
double variance_of_means(const Vector& scores, Index length) {
  const Index n = scores.size(), count = n - length + 1;
  const double mean = scores.mean();
  double sum = scores.head(length).sum(), squares = 0;
  for (Index i = 0; i < count; ++i) {
    const double deviation = sum / double(length) - mean;
    squares += deviation * deviation;
    if (i + length < n) sum += scores(i + length) - scores(i);
  }
  return squares / double(count) * double(n) / double(n - length);
}

/// Sum of ln(1 + factor (score - mean)), none below that of 0: by products, which cost a tenth of
/// as many logarithms.
double sum_of_logs(const Vector& scores, double mean, double factor) {
  constexpr Index together = 16;  // each at least 1e-16 where it is not 0
  double sum = 0;
  for (Index i = 0; i < scores.size(); i += together) {
    const auto some = scores.segment(i, std::min(together, scores.size() - i)).array();
    sum += std::log((1 + factor * (some - mean)).max(0).prod());
  }
  return sum;
}

}  // namespace

double dependence(const ScoreSeries& series) {
  const Index n = series.scores.size();
  const double measured = std::min(1.0, double(n) / double(cycles_to_measure * series.cycle));
  double largest = 1;
  if (series.assumed == 0)
    largest = measured + (1 - measured) * double(series.cycle);
  else if (measured < 1)
    largest = series.assumed;
  if (n < 2) return largest;
  const double of_one = variance(series.scores);
  if (!(of_one > rounding * rounding * series.bound * series.bound)) return largest;
  for (Index length = 2; n / length >= least_means; length *= 2) {
    // By a standard deviation more, of 3/2 as many independent means as fit in: the ratio of so
    // few is uncertain.
    const double uncertain = 1 + std::sqrt(2.0 / (1.5 * double(n) / double(length) - 1));
    largest = std::max(
        largest, double(length) * variance_of_means(series.scores, length) / of_one * uncertain);
  }
  return largest;
}

double log_wealth(const ScoreSeries& series, double dependence, double mean) {
  assert(std::abs(mean) < series.bound);
  std::array<double, bets.size()> logs{};
  for (std::size_t i = 0; i < bets.size(); ++i)
    logs[i] = sum_of_logs(series.scores, mean, bets[i] / (series.bound + mean)) / dependence;
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
