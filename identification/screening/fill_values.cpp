#include "identification/screening/fill_values.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident::identification {
namespace {

// Times the greatest magnitude of the others: where they have another sign, and for any value. An
// equipment that switches on may well draw a hundred times the noise of its current before.
constexpr double far = 10, absurd = 1e4;
constexpr Index least_fills = 2;
// Of any value that is scattered over the rows, such as 0: plateaus, their share of all, and the
// share of them at which another channel may jump by chance.
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

/// Sorted values [begin, end): the others, and whether `value` may stand for none beside them.
bool stands_for_none(double value, const std::vector<double>& sorted, std::size_t begin,
                     std::size_t end) {
  const double low = sorted[begin], high = sorted[end - 1];
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

double median_size(const std::vector<Plateau>& plateaus) {
  std::vector<double> sizes;
  for (const Plateau& plateau : plateaus) sizes.push_back(double(plateau.size()));
  return quantile(std::move(sizes), 0.5);
}

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
    std::vector<Plateau> fills, others;
    double low = channel.high, high = channel.low;
    for (const Plateau& plateau : channel.plateaus) {
      (plateau.value == value ? fills : others).push_back(plateau);
      if (plateau.value == value) continue;
      low = std::min(low, plateau.value);
      high = std::max(high, plateau.value);
    }
    const double gap = std::max(low - value, value - high);
    if (!(high > low) || gap <= high - low || median_size(fills) > 2 * median_size(others) ||
        another_jumps(channels, self, fills))
      continue;
    return fills;
  }
  return {};
}

std::vector<double> fill_values(const Vector& values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> found;
  std::size_t begin = 0, end = sorted.size();
  while (begin < end) {
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(end);
    const auto above =
        static_cast<std::size_t>(std::upper_bound(first, last, sorted[begin]) - sorted.begin());
    const auto below =
        static_cast<std::size_t>(std::lower_bound(first, last, sorted[end - 1]) - sorted.begin());
    if (above < end && above - begin >= static_cast<std::size_t>(least_fills) &&
        stands_for_none(sorted[begin], sorted, above, end)) {
      found.push_back(sorted[begin]);
      begin = above;
    } else if (below > begin && end - below >= static_cast<std::size_t>(least_fills) &&
               stands_for_none(sorted[end - 1], sorted, begin, below)) {
      found.push_back(sorted[end - 1]);
      end = below;
    } else {
      break;
    }
  }
  return found;
}

}  // namespace reident::identification
