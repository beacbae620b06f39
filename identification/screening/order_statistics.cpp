#include "identification/screening/order_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "identification/numerics/cpu_clones.hpp"

namespace reident::identification {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();
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
  return {place < margin ? -unlimited : sample[place - margin],
          place + margin >= sampled ? unlimited : sample[place + margin]};
}

/// Copies the values from `low` to `high` to `to`, which has room for all. Returns how many there
/// are; `below` becomes how many lie before.
REIDENT_CLONES std::size_t gather(const double* values, std::size_t count, double low, double high,
                                  double* to, std::size_t& below) {
  const Four one = Four{} + 1.0;
  Four befores{};
  std::size_t gathered = 0;
  const auto take = [&](double value) __attribute__((always_inline)) {
    to[gathered] = value;
    gathered += value >= low && value <= high ? 1U : 0U;
  };
  const std::size_t eights = count / 8 * 8;
  for (std::size_t i = 0; i < eights; i += 8) {
    const Four a = load(values + i), b = load(values + i + 4);
    befores += (a < low ? one : Four{}) + (b < low ? one : Four{});
    const auto any = ((a >= low) & (a <= high)) | ((b >= low) & (b <= high));
    if ((any[0] | any[1] | any[2] | any[3]) == 0) continue;
    for (std::size_t k = i; k < i + 8; ++k) take(values[k]);
  }
  below = static_cast<std::size_t>(befores[0] + befores[1] + befores[2] + befores[3]);
  for (std::size_t i = eights; i < count; ++i) {
    below += values[i] < low ? 1U : 0U;
    take(values[i]);
  }
  return gathered;
}

/// Four at a time: the least and the greatest value that is more than `above` and less than
/// `below`.
REIDENT_CLONES void limits(const double* values, std::size_t count, double above, double below,
                           double& low, double& high) {
  const Four none = unlimited - Four{};
  Four lows = none, highs = -none;
  const std::size_t fours = count / 4 * 4;
  for (std::size_t i = 0; i < fours; i += 4) {
    const Four value = load(values + i);
    const auto is_between = (value > above) & (value < below);
    const Four up = is_between ? value : none, down = is_between ? value : -none;
    lows = up < lows ? up : lows;
    highs = down > highs ? down : highs;
  }
  low = unlimited, high = -unlimited;
  for (int lane = 0; lane < 4; ++lane) {
    low = std::min(low, lows[lane]);
    high = std::max(high, highs[lane]);
  }
  for (std::size_t i = fours; i < count; ++i)
    if (values[i] > above && values[i] < below) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
}

/// How many values are `value`.
REIDENT_CLONES double count_of(const double* values, std::size_t count, double value) {
  const Four one = Four{} + 1.0;
  Four counts{};
  const std::size_t fours = count / 4 * 4;
  for (std::size_t i = 0; i < fours; i += 4) counts += load(values + i) == value ? one : Four{};
  double sum = counts[0] + counts[1] + counts[2] + counts[3];
  for (std::size_t i = fours; i < count; ++i) sum += values[i] == value ? 1 : 0;
  return sum;
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
    std::size_t below = 0;
    const std::size_t count =
        gather(values.data(), values.size(), bracket.low, bracket.high, within.get(), below);
    if (below <= rank && rank < below + count) return select(count, rank - below);
  }
  std::copy(values.begin(), values.end(), within.get());
  return select(values.size(), rank);
}

double quantile(std::span<const double> values, double share) {
  return nth_smallest(values, static_cast<std::size_t>(share * double(values.size() - 1)));
}

Ends ends_of(std::span<const double> values, double above, double below) {
  const double* data = values.data();
  const std::size_t size = values.size();
  Ends ends{unlimited, unlimited, -unlimited, -unlimited, 0, 0};
  limits(data, size, above, below, ends.low, ends.high);
  ends.at_low = static_cast<std::ptrdiff_t>(count_of(data, size, ends.low));
  ends.at_high = static_cast<std::ptrdiff_t>(count_of(data, size, ends.high));
  double other;
  limits(data, size, ends.low, below, ends.next_to_low, other);
  limits(data, size, above, ends.high, other, ends.next_to_high);
  return ends;
}

}  // namespace reident::identification
