#include "identification/screening/fill_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/screening/order_statistics.hpp"
#include "identification/screening/witnesses.hpp"

namespace reident::identification {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Times the greatest magnitude of the others: where they have another sign, and for any value. An
// equipment that switches on may well draw a hundred times the noise of its current before.
constexpr double far = 10, absurd = 1e4;
// A value of any kind that is scattered over the rows, such as 0: its plateaus, their share of all,
// and the share of them at which another channel may jump by chance.
constexpr Index least_scattered = 3;
constexpr double most_scattered = 0.25, jumps_together = 0.5;
// Plateaus of more than twice the usual length: their rows, their share of all rows, and the
// deviations by which another channel turns at them, as at what the equipment does.
constexpr double longest_scattered = 30, most_scattered_rows = 0.1, turned_deviations = 4;

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

/// Whether `value`, of so many samples, may stand for none beside others from `low` to `high`.
bool stands_for_none(double value, Index count, double low, double high) {
  const double greatest = std::max(std::abs(low), std::abs(high));
  const double gap = value < low ? low - value : value - high;
  const bool other_sign = value < 0 ? low >= 0 : high <= 0;
  const bool is_repeated = count > 1;
  const double least = other_sign && is_repeated ? far : absurd;
  if (greatest > 0 && std::abs(value) >= least * greatest) return true;
  return gap > high - low && gap > 0 && high > low &&
         (is_of_nines(std::abs(value)) || is_end_of_integers(value));
}

/// Whether another channel jumps at most of these plateaus: they may be what the equipment does.
bool another_jumps(const Witnesses& witnesses, const std::vector<Plateau>& plateaus) {
  const std::vector<Channel>& channels = witnesses.channels;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == witnesses.self) continue;
    const Vector& values = channels[c].values;
    const auto jumps = std::count_if(plateaus.begin(), plateaus.end(), [&](const Plateau& at) {
      return witnesses.saw(c, at) &&
             movement(values, std::max<Index>(at.begin - 1, 0),
                      std::min<Index>(at.end + 1, values.size())) > channels[c].least_jump;
    });
    if (double(jumps) > jumps_together * double(plateaus.size())) return true;
  }
  return false;
}

/// Whether another channel turns at plateaus: what it does from before one to behind it, less what
/// it did over as many rows before, is not what it does elsewhere.
bool another_turns(const Witnesses& witnesses, const std::vector<Plateau>& plateaus) {
  const std::vector<Channel>& channels = witnesses.channels;
  const std::size_t self = witnesses.self;
  const auto rows = static_cast<Index>(median_size(plateaus)) + 1;
  const Index all = channels[self].values.size();
  std::vector<bool> is_away(static_cast<std::size_t>(all));
  for (const Plateau& one : plateaus)
    std::fill(is_away.begin() + one.begin, is_away.begin() + one.end, true);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self || !(channels[c].range() > 0)) continue;
    const Vector& values = channels[c].values;
    const auto turn_at = [&](Index row, Index later) {
      return values(row + later) - 2 * values(row) + values(row - later);
    };
    double sum = 0, squares = 0;
    Index count = 0, elsewhere = 0;
    for (const Plateau& one : plateaus) {
      const Index row = one.begin - 1, later = one.size() + 1;
      if (row < later || row + later >= all || !witnesses.saw(c, one)) continue;
      sum += turn_at(row, later);
      ++count;
    }
    for (Index row = rows; row + rows < all; ++row) {
      if (is_away[static_cast<std::size_t>(row + 1)]) continue;
      squares += std::pow(turn_at(row, rows), 2);
      ++elsewhere;
    }
    if (count == 0 || elsewhere == 0) continue;
    const double usual = std::sqrt(squares / double(elsewhere));
    if (std::abs(sum) > turned_deviations * usual * std::sqrt(double(count))) return true;
  }
  return false;
}

}  // namespace

std::vector<Plateau> scattered_fills(const std::vector<Channel>& channels, std::size_t self) {
  const Channel& channel = channels[self];
  const Ends ends = ends_of(span_of(channel.values), -infinity, infinity);
  for (const bool is_low : {true, false}) {
    if ((is_low ? ends.at_low : ends.at_high) < least_scattered) continue;
    const double value = is_low ? ends.low : ends.high;
    const double low = is_low ? ends.next_to_low : ends.low;
    const double high = is_low ? ends.high : ends.next_to_high;
    const double gap = std::max(low - value, value - high);
    if (!(high > low) || gap <= high - low) continue;
    std::vector<Plateau> fills, others;
    for (const Plateau& plateau : channel.plateaus())
      (plateau.value == value ? fills : others).push_back(plateau);
    const double share = double(fills.size()) / double(fills.size() + others.size());
    if (std::ssize(fills) < least_scattered || share > most_scattered) continue;
    const Witnesses witnesses = witnesses_of(channels, self, fills);
    if (another_jumps(witnesses, fills)) continue;
    const double length = median_size(fills);
    const auto rows = double(is_low ? ends.at_low : ends.at_high);
    if (length > 2 * median_size(others) &&
        (length > longest_scattered || rows > most_scattered_rows * double(channel.values.size()) ||
         another_turns(witnesses, fills)))
      continue;
    return fills;
  }
  return {};
}

std::vector<double> fill_values(const Vector& values) {
  std::vector<double> found;
  double above = -infinity, below = infinity;  // the values that are left lie between
  while (true) {
    const Ends ends = ends_of(span_of(values), above, below);
    if (!(ends.low < ends.high)) return found;
    if (stands_for_none(ends.low, ends.at_low, ends.next_to_low, ends.high)) {
      found.push_back(ends.low);
      above = ends.low;
    } else if (stands_for_none(ends.high, ends.at_high, ends.low, ends.next_to_high)) {
      found.push_back(ends.high);
      below = ends.high;
    } else {
      return found;
    }
  }
}

}  // namespace reident::identification
