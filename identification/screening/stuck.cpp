#include "identification/screening/stuck.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr Index least_stuck_rows = 20;  // where a channel rests at other times
constexpr double longer = 2.5;          // than the longest of the others
constexpr double by_chance = 1e-6;      // expected number of repetitions so long
constexpr std::size_t most_stuck = 20;  // plateaus of one channel
constexpr double repeated_share = 1.0 / 3;
/// At the end of its range a sensor has nothing to show: its cause is absent.
constexpr double end_share = 0.02;
/// Rows beyond an end, of those that rest at it: a spike there makes no new end.
constexpr double beyond_share = 0.1;
/// What another channel moves meanwhile, as a share of its range; or as usual over as many rows
/// elsewhere.
constexpr double moving_share = 0.1;
constexpr Index windows = 50;
constexpr double quiet = 0.25;  // of these windows
/// Rows at least that an output settles for when its inputs have come to rest.
constexpr Index least_settling = 5;
/// The samples that differ from the one before, of a channel whose noise never lets it rest.
constexpr double restless_share = 0.9;

/// The rows in the middle of a plateau: where it began and ended, another channel stood still for
/// other reasons.
RowRange middle_of(const Plateau& plateau) {
  const Index begin = plateau.begin + plateau.size() / 4;
  return {begin, begin + plateau.size() / 2};
}

/// What the channel moves over so many rows, in places outside of the plateau; may be empty.
std::vector<double> movements_elsewhere(const Channel& channel, Index rows,
                                        const Plateau& plateau) {
  std::vector<double> movements;
  for (Index i = 0; i < windows; ++i) {
    const Index begin = (channel.values.size() - rows) * i / (windows - 1);
    if (begin >= plateau.end || begin + rows <= plateau.begin)
      movements.push_back(movement(channel.values, begin, begin + rows));
  }
  return movements;
}

bool another_moves(const std::vector<Channel>& channels, std::size_t self, const Plateau& plateau) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self || !channels[c].is_analog) continue;
    const auto [begin, end] = middle_of(plateau);
    const double moved = movement(channels[c].values, begin, end);
    if (moved > moving_share * channels[c].range()) return true;
    const auto elsewhere = movements_elsewhere(channels[c], end - begin, plateau);
    if (moved > 0 && !elsewhere.empty() && moved >= quantile(elsewhere, quiet)) return true;
  }
  return false;
}

/// Whether the channel moves in the middle of the plateau, and less than half of what it does over
/// as many rows anywhere else.
bool is_unusually_quiet(const Channel& channel, const Plateau& plateau) {
  const auto [begin, end] = middle_of(plateau);
  const double moved = movement(channel.values, begin, end);
  const auto elsewhere = movements_elsewhere(channel, end - begin, plateau);
  return moved > 0 && !elsewhere.empty() &&
         moved < 0.5 * *std::min_element(elsewhere.begin(), elsewhere.end());
}

/// Whether the equipment is at rest: all inputs stand still, and the outputs are quieter than they
/// ever are, or came to rest after that. A sensor that is stuck changes nothing in the other
/// channels, and rows that are held begin in all of them at once.
bool is_at_rest(const std::vector<Channel>& channels, std::size_t self, std::size_t inputs,
                const Plateau& plateau) {
  const auto is_still = [](const Channel& channel, Index begin, Index end) {
    return movement(channel.values, begin, end) == 0;
  };
  const auto outputs = channels.begin() + static_cast<std::ptrdiff_t>(inputs);
  if (self < inputs)
    return std::all_of(outputs, channels.end(), [&](const Channel& output) {
      const auto [begin, end] = middle_of(plateau);
      const Index settling = std::max(least_settling, plateau.size() / 10);
      const bool rests = is_still(output, begin, end) &&
                         !is_still(output, plateau.begin + 1, plateau.begin + settling);
      return rests || is_unusually_quiet(output, plateau);
    });
  // It rests on for its dead time when they move again.
  const Index end = middle_of(plateau).end;
  const Index before =
      std::max(plateau.begin - least_settling, (*channels[self].segments)[plateau.segment].begin);
  return inputs > 0 && std::all_of(channels.begin(), outputs, [&](const Channel& input) {
           return is_still(input, before, end);
         });
}

bool is_monotonic(const Vector& values, Index begin, Index end) {
  const auto first = values.begin() + begin, last = values.begin() + end;
  return std::is_sorted(first, last) || std::is_sorted(first, last, std::greater<>());
}

/// Whether the channel moves little and one way where the plateau begins, or ends where it begins
/// with the segment: one without noise slows down where it turns, and before it rests. A sensor
/// that is stuck stops at once.
bool slows_down(const Channel& channel, const Plateau& plateau) {
  const Segment& segment = (*channel.segments)[plateau.segment];
  Index begin = plateau.begin - least_settling;
  if (begin < segment.begin) begin = plateau.end - 1;
  const Index rows = std::min(least_settling + 1, segment.end - begin);
  if (!is_monotonic(channel.values, begin, begin + rows)) return false;
  const auto elsewhere = movements_elsewhere(channel, rows, plateau);
  return !elsewhere.empty() &&
         movement(channel.values, begin, begin + rows) < 0.5 * quantile(elsewhere, quiet);
}

bool is_repeated_elsewhere(const std::vector<Plateau>& plateaus, const Plateau& plateau) {
  const double least = repeated_share * double(plateau.size());
  return std::any_of(plateaus.begin(), plateaus.end(), [&](const Plateau& other) {
    return other.begin != plateau.begin && other.value == plateau.value &&
           double(other.size()) >= least;
  });
}

/// Whether the channel rests at an end of its range, with hardly a row beyond, and does not vary
/// there at other times. Where noise lets it rest nowhere else, hardly a row may have another value
/// there: a sensor that is stuck near an end has seen more.
bool rests_at_end_of_range(const Channel& channel, const std::vector<Plateau>& plateaus,
                           const Plateau& plateau, bool rests_nowhere_else) {
  const double near = end_share * channel.range();
  const double few = beyond_share * double(plateau.size());
  const auto rests_at = [&](double outwards) {  // 1: the high end
    Index beyond = 0, rows = 0, longest = 0;
    for (const Plateau& other : plateaus) {
      if (other.begin == plateau.begin && other.segment == plateau.segment) continue;
      const double further = outwards * (other.value - plateau.value);
      if (further > (rests_nowhere_else ? 0 : near)) beyond += other.size();
      if (std::abs(further) > near || (rests_nowhere_else && further == 0)) continue;
      rows += other.size();
      longest = std::max(longest, other.size());
    }
    const double most_there = rests_nowhere_else ? few : double(plateau.size());
    return double(beyond) <= few && (double(rows) < most_there ||
                                     double(longest) >= repeated_share * double(plateau.size()));
  };
  return rests_at(-1) || rests_at(1);
}

/// Plateaus that are longer than chance makes them, of a channel that else rests or never does.
struct LongPlateaus {
  std::vector<Plateau> plateaus;
  /// Whether the rest of the channel has a new value in nearly every row, as noise gives it: then
  /// it does not rest for want of a cause.
  bool rests_nowhere_else = false;
};

/// The longest plateaus, as many as chance does not explain: each sample of the rest of the channel
/// repeats the one before with some probability, and none of the rest is nearly as long. They are
/// exceptions: the rest has as many plateaus at least.
LongPlateaus unusually_long(const Channel& channel, const std::vector<Plateau>& of_all) {
  const std::size_t all = of_all.size();
  LongPlateaus result{std::vector<Plateau>(std::min(all, most_stuck + 1))};  // and one more
  std::vector<Plateau>& plateaus = result.plateaus;
  if (plateaus.size() < 4) return {};  // hardly any samples to compare with
  std::partial_sort_copy(of_all.begin(), of_all.end(), plateaus.begin(), plateaus.end(),
                         [](const Plateau& a, const Plateau& b) {
                           return a.size() != b.size() ? a.size() > b.size() : a.begin < b.begin;
                         });
  std::size_t count = plateaus.size() - 1;
  Index rest = channel.values.size();  // rows of the plateaus behind the longest ones
  for (std::size_t i = 0; i < count; ++i) rest -= plateaus[i].size();
  for (; count > 0; --count) {
    const auto others = double(all - count);
    // One repetition more than there are: none may be by chance.
    const double log_repeats = std::log((double(rest) - others + 1) / (double(rest) + 1));
    const auto least = double(plateaus[count - 1].size());
    result.rests_nowhere_else = others >= restless_share * double(rest);
    if (others >= double(count) &&
        (result.rests_nowhere_else || plateaus[count - 1].size() >= least_stuck_rows) &&
        least >= longer * double(plateaus[count].size()) &&
        std::log(others) + (least - 1) * log_repeats < std::log(by_chance))
      break;
    rest += plateaus[count - 1].size();
  }
  plateaus.resize(count);
  return result;
}

}  // namespace

std::vector<Plateau> stuck_plateaus(const std::vector<Channel>& channels, std::size_t self,
                                    std::size_t inputs) {
  const Channel& channel = channels[self];
  const Index rows = channel.longest_repeat;
  const double rest = double(channel.values.size() - Index(most_stuck) * rows);
  if (rows < least_stuck_rows &&
      (double(rows) < longer || double(channel.steps) < restless_share * rest))
    return {};
  const std::vector<Plateau> plateaus = channel.plateaus();
  const auto [longest, rests_nowhere_else] = unusually_long(channel, plateaus);
  std::vector<Plateau> stuck;
  for (const Plateau& plateau : longest)
    if (!rests_at_end_of_range(channel, plateaus, plateau, rests_nowhere_else) &&
        !is_repeated_elsewhere(plateaus, plateau) &&
        (rests_nowhere_else
             ? !slows_down(channel, plateau) && !is_at_rest(channels, self, inputs, plateau)
             : another_moves(channels, self, plateau)))
      stuck.push_back(plateau);
  std::sort(stuck.begin(), stuck.end(),
            [](const Plateau& a, const Plateau& b) { return a.begin < b.begin; });
  return stuck;
}

}  // namespace reident::identification
