#include "identification/screening/order_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace reident::identification {
namespace {

constexpr std::size_t sampled = 512;
constexpr double deviations = 3.5;  // of a rank in the sample

/// Values between which a rank is likely to lie.
struct Bracket {
  double low, high;
};

Bracket bracket_of(std::span<const double> values, std::size_t rank) {
  std::array<double, sampled> sample;
  for (std::size_t i = 0; i < sampled; ++i) sample[i] = values[i * values.size() / sampled];
  std::sort(sample.begin(), sample.end());
  const double share = double(rank) / double(values.size());
  const auto place = static_cast<std::size_t>(share * sampled);
  const auto margin =
      static_cast<std::size_t>(2 + deviations * std::sqrt(share * (1 - share) * sampled));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {place < margin ? -infinity : sample[place - margin],
          place + margin >= sampled ? infinity : sample[place + margin]};
}

}  // namespace

double nth_smallest(std::span<const double> values, std::size_t rank) {
  const auto within = std::make_unique_for_overwrite<double[]>(values.size());
  const auto select = [&](std::size_t count, std::size_t place) {
    std::nth_element(within.get(), within.get() + place, within.get() + count);
    return within[place];
  };
  if (values.size() > 2 * sampled) {
    const Bracket bracket = bracket_of(values, rank);
    std::size_t below = 0, count = 0;
    for (const double value : values) {
      within[count] = value;
      below += value < bracket.low ? 1U : 0U;
      count += value >= bracket.low && value <= bracket.high ? 1U : 0U;
    }
    if (below <= rank && rank < below + count) return select(count, rank - below);
  }
  std::copy(values.begin(), values.end(), within.get());
  return select(values.size(), rank);
}

double quantile(std::span<const double> values, double share) {
  return nth_smallest(values, static_cast<std::size_t>(share * double(values.size() - 1)));
}

}  // namespace reident::identification
