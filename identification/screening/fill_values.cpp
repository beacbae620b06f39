#include "identification/screening/fill_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace reident::identification {
namespace {

// Times the greatest magnitude of the others: where they have another sign, and for any value. An
// equipment that switches on may well draw a hundred times the noise of its current before.
constexpr double far = 10, absurd = 1e4;
constexpr Index least_fills = 2;
// A value of any kind that is scattered over the rows, such as 0: its plateaus, their share of all,
// and the share of them at which another channel may jump by chance.
constexpr std::size_t least_scattered = 3;
constexpr double most_scattered = 0.25, jumps_together = 0.5;

bool is_of_nines(double magnitude) {
  for (double nines = 99; nines < 1e16; nines = 10 * nines + 9)
    for (const double fraction : {1.0, 10.0, 100.0, 1000.0})
      if (magnitude == nines / fraction && magnitude >= 99) return true;
  return false;
}

bool is_end_of_integers(double value) {
  for (const double bits : {8.0, 16.0, 32.0}) {
    const double all = std::exp2(bits), half = all / 2;
    if (value == all - 1 || value == half - 1 || value == -half) return true;
  }
  return false;
}

/// Whether `value` may stand for none beside others from `low` to `high`.
bool stands_for_none(double value, double low, double high) {
  const double greatest = std::max(std::abs(low), std::abs(high));
  const double gap = value < low ? low - value : value - high;
  const bool other_sign = value < 0 ? low >= 0 : high <= 0;
  if (greatest > 0 && std::abs(value) >= (other_sign ? far : absurd) * greatest) return true;
  return gap > high - low && gap > 0 && high > low &&
         (is_of_nines(std::abs(value)) || is_end_of_integers(value));
}

/// Whether another channel jumps at most of these plateaus: they may be what the equipment does.
bool another_jumps(const std::vector<Channel>& channels, std::size_t self,
                   const std::vector<Plateau>& plateaus) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self) continue;
    const Vector& values = channels[c].values;
    const auto jumps = std::count_if(plateaus.begin(), plateaus.end(), [&](const Plateau& at) {
      return movement(values, std::max<Index>(at.begin - 1, 0),
                      std::min<Index>(at.end + 1, values.size())) > channels[c].least_jump;
    });
    if (double(jumps) > jumps_together * double(plateaus.size())) return true;
  }
  return false;
}

/// The lowest of some values, how many they are, and the lowest of the others.
struct Lowest {
  double value = std::numeric_limits<double>::infinity(), next = value;
  Index count = 0;

  void add(double other) {
    if (other < value) {
      next = value;
      value = other;
      count = 1;
    } else if (other == value) {
      ++count;
    } else {
      next = std::min(next, other);
    }
  }
};

}  // namespace

std::vector<Plateau> scattered_fills(const std::vector<Channel>& channels, std::size_t self) {
  const Channel& channel = channels[self];
  std::size_t at_low = 0, at_high = 0;  // a look that costs little: as a rule neither is repeated
  for (const Plateau& plateau : channel.plateaus) {
    at_low += plateau.value == channel.low ? 1U : 0U;
    at_high += plateau.value == channel.high ? 1U : 0U;
  }
  for (const auto& [value, count] : {std::pair(channel.low, at_low), {channel.high, at_high}}) {
    const double share = double(count) / double(channel.plateaus.size());
    if (count < least_scattered || share > most_scattered) continue;
    double low = channel.high, high = channel.low;
    for (const Plateau& plateau : channel.plateaus) {
      if (plateau.value == value) continue;
      low = std::min(low, plateau.value);
      high = std::max(high, plateau.value);
    }
    const double gap = std::max(low - value, value - high);
    if (!(high > low) || gap <= high - low) continue;
    std::vector<Plateau> fills, others;
    for (const Plateau& plateau : channel.plateaus)
      (plateau.value == value ? fills : others).push_back(plateau);
    if (median_size(fills) > 2 * median_size(others) || another_jumps(channels, self, fills))
      continue;
    return fills;
  }
  return {};
}

std::vector<double> fill_values(const Vector& values) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> found;
  double above = -infinity, below = infinity;  // the values that are left lie between
  while (true) {
    Lowest low, high;  // the highest is the lowest of the other sign
    for (const double value : values) {
      if (!(value > above && value < below)) continue;
      low.add(value);
      high.add(-value);
    }
    if (!(low.value < -high.value)) return found;
    if (low.count >= least_fills && stands_for_none(low.value, low.next, -high.value)) {
      found.push_back(low.value);
      above = low.value;
    } else if (high.count >= least_fills && stands_for_none(-high.value, low.value, -high.next)) {
      found.push_back(-high.value);
      below = -high.value;
    } else {
      return found;
    }
  }
}

}  // namespace reident::identification
