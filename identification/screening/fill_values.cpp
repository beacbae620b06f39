#include "identification/screening/fill_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identification/screening/answers.hpp"
#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Times the greatest magnitude of the others: where they have another sign, and for any value. An
// equipment that switches on may well draw a hundred times the noise of its current before.
constexpr double far = 10, absurd = 1e4;
// How far outside of the others a number of nines lies that has another sign, of their range.
constexpr double least_gap = 0.05;
// A value of any kind that is scattered over the rows, such as 0: its plateaus, their share of all
// plateaus, that of long ones of all rows, and the share of them at which another channel may jump.
constexpr Index least_scattered = 3;
constexpr double most_scattered = 0.35, most_long = 0.25, jumps_together = 0.5;
// A value of excursions: how many have it, and how much more often it is repeated than others are.
constexpr Index least_repeated = 5;
constexpr double more_often = 5, exact_share = 0.9;
constexpr double longest_off_command = 2;  // rows of a plateau of a channel that is not analog
// Plateaus of more than twice the usual length: their rows, and the deviations by which another
// channel turns at them, as at what the equipment does.
constexpr double longest_scattered = 30, turned_deviations = 4;
// Rows within which another channel follows what begins and ends there, or is followed by it, and
// the deviations of their correlation.
constexpr Index most_rows_apart = 8;
constexpr double related_deviations = 5;

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
  // None lies on the way to a number of another sign that returns to the digit.
  const double away = other_sign && count >= least_scattered ? least_gap : 1;
  return gap > away * (high - low) && gap > 0 && high > low &&
         (is_of_nines(std::abs(value)) || is_end_of_integers(value));
}

/// The rows that no plateau has.
std::vector<bool> rows_elsewhere(Index rows, const std::vector<Plateau>& plateaus) {
  std::vector<bool> is_elsewhere(static_cast<std::size_t>(rows), true);
  for (const Plateau& one : plateaus)
    std::fill(is_elsewhere.begin() + one.begin, is_elsewhere.begin() + one.end, false);
  return is_elsewhere;
}

/// Whether so many of `count` are more than chance gives in 99 of 100 cases, by Chernoff's bound
/// of the binomial distribution.
bool are_more_than_chance(double found, double count, double chance) {
  const double share = found / count;
  if (share <= chance || chance >= 1) return false;
  const auto part = [](double of, double than) { return of > 0 ? of * std::log(of / than) : 0; };
  return chance == 0 || count * (part(share, chance) + part(1 - share, 1 - chance)) > std::log(100);
}

/// Whether another channel jumps at most of these plateaus, and more often than in as many rows
/// elsewhere: they may be what the equipment does. It may jump anywhere within, or at both ends.
bool another_jumps(const Witnesses& witnesses, const std::vector<Plateau>& plateaus) {
  const std::vector<Channel>& channels = witnesses.channels;
  const Index all = channels[witnesses.self].values.size();
  const auto length = static_cast<Index>(median_size(plateaus));
  const std::vector<bool> is_elsewhere = rows_elsewhere(all, plateaus);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == witnesses.self) continue;
    const auto moves = [&](Index begin, Index end) {
      return movement(channels[c].values, std::max<Index>(begin, 0), std::min(end, all)) >
             channels[c].least_jump;
    };
    const auto jumps = [&](Index begin, Index end) { return moves(begin - 1, end + 1); };
    const auto jumps_at_ends = [&](Index begin, Index end) {
      return moves(begin - 1, begin + 1) && moves(end - 1, end + 1);
    };
    const auto confirms = [&](const auto& predicate) {
      double found = 0, chances = 0, by_chance = 0;
      for (const Plateau& at : plateaus)
        found += witnesses.saw(c, at) && predicate(at.begin, at.end) ? 1 : 0;
      if (found <= jumps_together * double(plateaus.size())) return false;
      Index clear = 0;  // rows elsewhere that end here
      for (Index end = 0; end < all; ++end) {
        clear = is_elsewhere[static_cast<std::size_t>(end)] ? clear + 1 : 0;
        if (clear < length + 2) continue;
        ++chances;
        by_chance += predicate(end - length, end) ? 1 : 0;
      }
      return are_more_than_chance(found, double(plateaus.size()),
                                  chances > 0 ? by_chance / chances : 0);
    };
    if (confirms(jumps) || confirms(jumps_at_ends)) return true;
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
  const std::vector<bool> is_elsewhere = rows_elsewhere(all, plateaus);
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
      if (!is_elsewhere[static_cast<std::size_t>(row + 1)]) continue;
      squares += std::pow(turn_at(row, rows), 2);
      ++elsewhere;
    }
    if (count == 0 || elsewhere == 0) continue;
    const double usual = std::sqrt(squares / double(elsewhere));
    if (std::abs(sum) > turned_deviations * usual * std::sqrt(double(count))) return true;
  }
  return false;
}

/// Whether another channel steps with the begins and ends of these plateaus, or some rows before or
/// behind: a value that stands for none comes and goes whatever the equipment does.
bool another_steps_with(const Witnesses& witnesses, const std::vector<Plateau>& plateaus) {
  const std::vector<Channel>& channels = witnesses.channels;
  const Channel& self = channels[witnesses.self];
  struct End {
    Index row;
    double sign;
  };
  std::vector<End> ends;
  for (const Plateau& one : plateaus) {
    const Segment& segment = (*self.segments)[one.segment];
    if (one.begin > segment.begin) ends.push_back({one.begin, 1});
    if (one.end < segment.end) ends.push_back({one.end, -1});
  }
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == witnesses.self || !(channels[c].range() > 0)) continue;
    const Vector& values = channels[c].values;
    // Where both hold the value, this one is bridged: the rest of such rows would be a bias.
    const auto is_none = [&](Index row) {
      return !witnesses.lost[c].empty() && values(row) == plateaus.front().value;
    };
    for (Index apart = -most_rows_apart; apart <= most_rows_apart; ++apart) {
      double sum = 0, squares = 0;
      for (const End& end : ends) {
        const Index row = end.row + apart;
        if (row < 1 || row >= values.size() || is_none(row - 1) || is_none(row)) continue;
        const double step = values(row) - values(row - 1);
        sum += end.sign * step;
        squares += step * step;
      }
      if (sum * sum > related_deviations * related_deviations * squares) return true;
    }
  }
  return false;
}

/// The ends of a channel that are further outside of the other values than these are apart; or as
/// far, of a channel that is not analog.
std::vector<double> far_ends(const Channel& channel) {
  std::vector<double> found;
  const Ends ends = ends_of(span_of(channel.values), -infinity, infinity);
  for (const bool is_low : {true, false}) {
    const double value = is_low ? ends.low : ends.high;
    const double low = is_low ? ends.next_to_low : ends.low;
    const double high = is_low ? ends.high : ends.next_to_high;
    const double gap = std::max(low - value, value - high);
    if ((is_low ? ends.at_low : ends.at_high) >= least_scattered && high > low &&
        (channel.is_analog ? gap > high - low : gap >= high - low))
      found.push_back(value);
  }
  return found;
}

/// How many of the values have each value; ascending.
std::vector<std::pair<double, Index>> counts_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<std::pair<double, Index>> counts;
  for (const double value : values) {
    if (counts.empty() || counts.back().first != value) counts.emplace_back(value, 0);
    ++counts.back().second;
  }
  return counts;
}

/// The values that a channel has as excursions again and again, while its other values are hardly
/// repeated.
std::vector<double> repeated_excursions(const Channel& channel) {
  std::vector<double> values;
  for (const Excursion& one : excursions_of(channel)) values.push_back(one.plateau.value);
  const auto excursions = counts_of(std::move(values));
  auto candidates = excursions;
  std::erase_if(candidates, [&](const auto& one) {
    if (one.second < least_repeated) return true;
    Index nearby = 0;  // a measured value has others around it
    for (const auto& [value, count] : excursions)
      nearby += std::abs(value - one.first) < channel.least_jump ? count : 0;
    return double(one.second) < exact_share * double(nearby);
  });
  if (candidates.empty()) return {};
  const std::vector<Plateau> plateaus = channel.plateaus();
  values.clear();
  for (const Plateau& one : plateaus) values.push_back(one.value);
  std::vector<double> repeats;
  for (const auto& [value, count] : counts_of(std::move(values)))
    repeats.insert(repeats.end(), static_cast<std::size_t>(count), double(count));
  const double usual = quantile(repeats, 0.5);
  std::vector<double> found;
  for (const auto& [value, returning] : candidates) {
    Index count = 0, jumping = 0, longest = 0;
    for (std::size_t i = 0; i < plateaus.size(); ++i) {
      const Plateau& one = plateaus[i];
      if (one.value != value) continue;
      const auto jumps_to = [&](std::size_t other) {
        return other < plateaus.size() && plateaus[other].segment == one.segment &&
               std::abs(plateaus[other].value - value) > channel.least_jump;
      };
      ++count;
      jumping += jumps_to(i - 1) || jumps_to(i + 1) ? 1 : 0;
      longest = std::max(longest, one.size());
    }
    if (double(count) >= more_often * usual && 2 * returning >= jumping &&
        double(longest) <= longest_scattered)
      found.push_back(value);
  }
  return found;
}

/// Whether plateaus of one value are few and short among the others of a channel, and no other
/// channel confirms them.
bool stand_for_none(const std::vector<Channel>& channels, std::size_t self,
                    const std::vector<Plateau>& fills, const std::vector<Plateau>& others) {
  if (std::ssize(fills) < least_scattered) return false;
  const double length = median_size(fills), usual = median_size(others);
  const double share = double(fills.size()) / double(fills.size() + others.size());
  // A command has few plateaus. One of its levels is not given for a row or two again and again.
  if (channels[self].is_analog ? share > most_scattered
                               : length > std::min(longest_off_command, usual / 2))
    return false;
  const Witnesses witnesses = witnesses_of(channels, self, fills);
  const Vector& values = channels[self].values;
  Index rows = 0;
  std::vector<Excursion> excursions;
  for (const Plateau& fill : fills) {
    rows += fill.size();
    if (fill.begin > (*channels[self].segments)[fill.segment].begin)
      excursions.push_back({fill, fill.value - values(fill.begin - 1)});
  }
  const bool is_long = length > 2 * usual;
  if (is_long && (length > longest_scattered || double(rows) > most_long * double(values.size()) ||
                  another_turns(witnesses, fills)))
    return false;
  if (another_jumps(witnesses, fills) || another_steps_with(witnesses, fills)) return false;
  const auto count = excursions.size();
  return 2 * unanswered(witnesses, std::move(excursions)).size() >= count;
}

}  // namespace

std::vector<Plateau> scattered_fills(const std::vector<Channel>& channels, std::size_t self) {
  std::vector<double> candidates = far_ends(channels[self]);
  for (const double value : repeated_excursions(channels[self]))
    if (std::find(candidates.begin(), candidates.end(), value) == candidates.end())
      candidates.push_back(value);
  if (candidates.empty()) return {};
  const std::vector<Plateau> plateaus = channels[self].plateaus();
  std::vector<Plateau> found;
  for (const double value : candidates) {
    std::vector<Plateau> fills, others;
    for (const Plateau& plateau : plateaus)
      (plateau.value == value ? fills : others).push_back(plateau);
    if (stand_for_none(channels, self, fills, others))
      found.insert(found.end(), fills.begin(), fills.end());
  }
  std::sort(found.begin(), found.end(),
            [](const Plateau& a, const Plateau& b) { return a.begin < b.begin; });
  return found;
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
