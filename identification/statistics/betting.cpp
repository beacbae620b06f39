#include "identification/statistics/betting.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace reident::identification {
namespace {

/// Shares of the largest bet. The wealth is divided among them in proportion to these.
constexpr std::array bets = {1.0, 0.5, 0.25, 0.125, 0.0625};
/// Means of so many scores show nothing where there are fewer of them.
constexpr Index least_means = 6;
/// Scores that differ by less, over their bound, are equal but for rounding.
constexpr double rounding = 1e-9;

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

Bet::Bet(ScoreSeries series) : series_(std::move(series)) {
  const Vector& scores = series_.scores;
  const Index n = scores.size();
  const double measured = std::min(1.0, double(n) / double(cycles_to_measure * series_.cycle));
  if (series_.assumed == 0)
    dependence_ = measured + (1 - measured) * double(series_.cycle);
  else if (measured < 1)
    dependence_ = series_.assumed;
  if (n < 2) return;
  const double of_one = (scores.array() - scores.mean()).square().sum() / double(n - 1);
  if (!(of_one > rounding * rounding * series_.bound * series_.bound)) return;
  for (Index length = 2; n / length >= least_means; length *= 2) {
    // By a standard deviation more, of 3/2 as many independent means as fit in: the ratio of so
    // few is uncertain.
    const double uncertain = 1 + std::sqrt(2.0 / (1.5 * double(n) / double(length) - 1));
    dependence_ = std::max(dependence_,
                           double(length) * variance_of_means(scores, length) / of_one * uncertain);
  }
}

double Bet::log_wealth(double mean) const {
  assert(std::abs(mean) < series_.bound);
  std::array<double, bets.size()> logs{};
  for (std::size_t i = 0; i < bets.size(); ++i)
    logs[i] = sum_of_logs(series_.scores, mean, bets[i] / (series_.bound + mean)) / dependence_;
  const double largest = *std::max_element(logs.begin(), logs.end());
  if (!std::isfinite(largest)) return largest;
  double wealth = 0, all = 0;
  for (std::size_t i = 0; i < bets.size(); ++i) {
    wealth += bets[i] * std::exp(logs[i] - largest);
    all += bets[i];
  }
  return largest + std::log(wealth / all);
}

double Bet::lower_mean(double log_threshold) const {
  double low = -series_.bound, high = series_.scores.size() > 0 ? series_.scores.mean() : low;
  constexpr int halvings = 40;
  for (int i = 0; i < halvings && low < high; ++i) {
    const double middle = (low + high) / 2;
    if (!(middle > -series_.bound)) break;
    (log_wealth(middle) > log_threshold ? low : high) = middle;
  }
  return low;
}

}  // namespace reident::identification
