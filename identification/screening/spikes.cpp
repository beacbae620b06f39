#include "identification/screening/spikes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "identification/screening/answers.hpp"
#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double most_spikes = 0.02;      // of the plateaus; more of them are how the equipment is
constexpr double most_irregular = 0.1;    // likewise where they have no usual height
constexpr double least_one_way = 0.1;     // of irregular ones
constexpr double irregular_spread = 0.5;  // of the heights' middle half, over the median
constexpr double longest_lost = 30;       // rows of a lost packet
constexpr double explained_share = 0.5;
constexpr std::size_t least_comparable = 3;

/// Whether all have one value, further outside of the other samples than these are apart.
bool are_one_absurd_value(const Channel& channel, const std::vector<Excursion>& spikes) {
  const double value = spikes.front().plateau.value;
  if (std::any_of(spikes.begin(), spikes.end(),
                  [value](const Excursion& one) { return one.plateau.value != value; }))
    return false;
  double low = 0, high = 0;
  bool any = false;
  for (const double other : channel.values) {
    if (other == value) continue;
    low = any ? std::min(low, other) : other;
    high = any ? std::max(high, other) : other;
    any = true;
  }
  return any && high > low && std::max(low - value, value - high) > high - low;
}

/// Whether these stand for anything: they go both ways, and their heights differ. Pulses of
/// equipment are alike.
bool are_irregular(const std::vector<Excursion>& spikes) {
  std::vector<double> heights;
  std::size_t upwards = 0;
  for (const Excursion& spike : spikes) {
    heights.push_back(std::abs(spike.height));
    upwards += spike.height > 0 ? 1U : 0U;
  }
  const double usual = quantile(heights, 0.5), least = least_one_way * double(spikes.size());
  return quantile(heights, 0.75) - quantile(heights, 0.25) > irregular_spread * usual &&
         double(upwards) >= least && double(spikes.size() - upwards) >= least;
}

/// What a channel does at a spike of another: how much it moves, and whether it comes back.
struct Jump {
  double size = 0;
  bool comes_back = false;
};

Jump jump_of(const Channel& channel, const Plateau& spike) {
  const double size = movement(channel.values, spike.begin - 1, spike.end + 1);
  const double stays = std::abs(channel.values(spike.end) - channel.values(spike.begin - 1));
  return {size, stays < neighbours_agree * size};
}

/// Whether this channel moves as much as in the spike when the other one steps as it does there.
bool step_explains(const Channel& self, const Channel& other, const Excursion& spike, double step) {
  const Index rows = spike.plateau.size() + 2;
  std::vector<double> moved;
  for (Index begin = 0; begin + rows <= self.values.size();) {
    const bool elsewhere = begin + rows < spike.plateau.begin || begin > spike.plateau.end;
    if (!elsewhere || movement(other.values, begin, begin + rows) < explained_share * step) {
      ++begin;
      continue;
    }
    moved.push_back(movement(self.values, begin, begin + rows));
    begin += rows;
  }
  const double height = std::abs(spike.height);
  // A moment of its own kind: it may be what the equipment does, where the value is a possible one.
  if (moved.size() < least_comparable) return height <= self.range() - height;
  return quantile(moved, 0.75) >= explained_share * height;
}

/// Moves those to the end that are further outside of the other samples than these are apart, and
/// returns where they begin.
std::vector<Excursion>::iterator absurd_last(const Channel& channel,
                                             std::vector<Excursion>& excursions) {
  Vector others = channel.values;
  for (const Excursion& one : excursions) bridge(others, one.plateau);
  const double low = others.minCoeff(), high = others.maxCoeff();
  return std::stable_partition(excursions.begin(), excursions.end(), [&](const Excursion& one) {
    return high == low || std::max(low - one.plateau.value, one.plateau.value - high) <= high - low;
  });
}

/// Those of the excursions that nothing explains, where they are few among so many plateaus.
std::vector<Excursion> faults_among(const std::vector<Excursion>& spikes,
                                    const Witnesses& witnesses, std::size_t plateaus) {
  if (spikes.empty()) return {};
  const Channel& channel = witnesses.channels[witnesses.self];
  const double share = double(spikes.size()) / double(plateaus);
  if (share > (are_irregular(spikes) ? most_irregular : most_spikes) &&
      !are_one_absurd_value(channel, spikes))
    return {};
  std::vector<Excursion> unexplained;
  std::vector<Index> beside;  // where those of them begin at which another channel jumps otherwise
  for (const Excursion& spike : spikes) {
    bool jumps = false, explained = false;
    for (std::size_t c = 0; c < witnesses.channels.size() && !explained; ++c) {
      const Channel& other = witnesses.channels[c];
      if (c == witnesses.self || !(other.range() > 0) || !witnesses.saw(c, spike.plateau)) continue;
      const Jump jump = jump_of(other, spike.plateau);
      if (!(jump.size > other.least_jump)) continue;
      jumps = true;
      explained = jump.comes_back || step_explains(channel, other, spike, jump.size);
    }
    if (explained) continue;
    unexplained.push_back(spike);
    if (jumps) beside.push_back(spike.plateau.begin);
  }
  unexplained = unanswered(witnesses, std::move(unexplained));
  const auto is_alone = [&](const Excursion& spike) {
    return !std::binary_search(beside.begin(), beside.end(), spike.plateau.begin);
  };
  std::vector<Excursion> alone;
  std::copy_if(unexplained.begin(), unexplained.end(), std::back_inserter(alone), is_alone);
  if (!alone.empty() && another_stands_out(witnesses, alone)) {
    double tallest = 0;  // of what the equipment does
    for (const Excursion& spike : alone) tallest = std::max(tallest, std::abs(spike.height));
    std::erase_if(unexplained, [&](const Excursion& spike) {
      return is_alone(spike) || std::abs(spike.height) <= 2 * tallest;
    });
  }
  return unexpected(witnesses, std::move(unexplained));
}

}  // namespace

std::vector<Plateau> spikes_of(const std::vector<Channel>& channels, std::size_t self) {
  const Channel& channel = channels[self];
  std::vector<Excursion> spikes = excursions_of(channel);
  if (spikes.empty()) return {};
  std::vector<Plateau> found;
  for (const Excursion& spike : spikes) found.push_back(spike.plateau);
  Witnesses witnesses = witnesses_of(channels, self, found);
  const std::vector<Plateau> plateaus = channel.plateaus();
  const double longest = 2 * median_size(plateaus);
  std::erase_if(spikes, [&](const Excursion& one) {
    const auto rows = double(one.plateau.size());
    return rows > (witnesses.is_lost(one.plateau) ? std::max(longest, longest_lost) : longest);
  });
  const auto absurd = absurd_last(channel, spikes);
  const std::size_t count = plateaus.size();
  auto faults = faults_among({absurd, spikes.end()}, witnesses, count);
  Channel& rest = witnesses.channels[self];  // says what the equipment does without these
  for (const Excursion& fault : faults) bridge(rest.values, fault.plateau);
  rest.low = rest.values.minCoeff();
  rest.high = rest.values.maxCoeff();
  const auto usual = faults_among({spikes.begin(), absurd}, witnesses, count);
  faults.insert(faults.end(), usual.begin(), usual.end());
  found.clear();
  for (const Excursion& fault : faults) found.push_back(fault.plateau);
  std::sort(found.begin(), found.end(),
            [](const Plateau& a, const Plateau& b) { return a.begin < b.begin; });
  return found;
}

}  // namespace reident::identification
