#include "identification/statistics/change_detection.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

/// With a known reference, a = 0.5 and independent normal z, the mean number of blocks between
/// false alarms is (exp(2 a b) - 2 a b - 1) / (2 a^2) = 19,000, b = limit + 1.166 (D. Siegmund,
/// "Sequential Analysis", Springer, 1985).
constexpr double limit = 8;
constexpr double most_of_a_block = 3;
/// A change may have begun where twice the logarithm of the likelihood is less by no more: a
/// twentieth of the best one's.
constexpr double possibly = 6;
/// Blocks that differ less than this, as a logarithm, differ by rounding.
constexpr double least_deviation = 1e-3;

}  // namespace

ChangeDetector::ChangeDetector(const Vector& reference)
    : ChangeDetector(reference, Vector::Ones(reference.size()), 1) {}

ChangeDetector::ChangeDetector(const Vector& reference, const Vector& weights, Index unknowns) {
  const double n = weights.sum();
  const double freedom = n - double(unknowns);
  assert(n >= least_blocks && freedom > 0);
  mean_ = weights.dot(reference) / n;
  const double squares = weights.dot((reference.array() - mean_).square().matrix());
  deviation_ = std::max(least_deviation, std::sqrt(squares / chi_squared_quantile(0.1, freedom)));
  allowance_ = 0.5 + 1 / std::sqrt(n);
}

bool ChangeDetector::add(double log_error, double weight) {
  const double z = (log_error - mean_) / deviation_;
  sum_ = std::max(0.0, sum_ + weight * (std::min(z, most_of_a_block) - weight * allowance_));
  if (sum_ == 0)
    risen_.clear();
  else
    risen_.emplace_back(std::min(z, 2 * most_of_a_block), weight);
  if (!(sum_ > limit)) return false;
  sum_ = 0;
  return true;
}

Index ChangeDetector::blocks_since() const {
  std::vector<double> likelihoods;  // twice the logarithm, of a change with the last blocks
  double sum = 0, weight = 0;
  for (auto block = risen_.rbegin(); block != risen_.rend(); ++block) {
    sum += block->first * block->second;
    weight += block->second * block->second;
    likelihoods.push_back(sum > 0 && weight > 0 ? sum * sum / weight : 0);
  }
  const double best = *std::max_element(likelihoods.begin(), likelihoods.end());
  const auto earliest = std::find_if(likelihoods.rbegin(), likelihoods.rend(),
                                     [&](double one) { return one >= best - possibly; });
  return likelihoods.rend() - earliest;
}

}  // namespace reident::identification
