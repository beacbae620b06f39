#include "identification/screening/spikes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double neighbours_agree = 0.3;
constexpr double most_spikes = 0.02;      // of the plateaus; more of them are how the equipment is
constexpr double most_irregular = 0.1;    // likewise where they have no usual height
constexpr double least_one_way = 0.1;     // of irregular ones
constexpr double irregular_spread = 0.5;  // of the heights' middle half, over the median
constexpr double explained_share = 0.5;
constexpr std::size_t least_comparable = 3;
constexpr double confirmed_deviations = 6;
constexpr Index compared_rows = 5000;

struct Spike {
  Plateau plateau;
  double height = 0;  // above both neighbours, or below them where negative
};

/// Plateaus that stand out from both neighbours.
std::vector<Spike> outstanding(const Channel& channel) {
  if (!(channel.greatest_step > channel.least_jump)) return {};
  std::vector<Spike> spikes;
  const Vector& values = channel.values;
  for (std::size_t s = 0; s < channel.segments->size(); ++s) {
    const Segment& segment = (*channel.segments)[s];
    for (Index row = segment.begin + 1; row < segment.end; ++row) {
      const double before = values(row - 1), value = values(row);
      if (!(std::abs(value - before) > channel.least_jump)) continue;
      Index end = row + 1;
      while (end < segment.end && values(end) == value) ++end;
      if (end == segment.end) break;
      const double up = value - before, down = value - values(end);
      const double height = std::min(std::abs(up), std::abs(down));
      if (height > channel.least_jump && up * down > 0 &&
          std::abs(values(end) - before) < neighbours_agree * height)
        spikes.push_back({{row, end, value, s}, up > 0 ? height : -height});
      row = end - 1;
    }
  }
  return spikes;
}

/// Whether all have one value, further outside of the other samples than these are apart.
bool are_one_absurd_value(const Channel& channel, const std::vector<Spike>& spikes) {
  const double value = spikes.front().plateau.value;
  if (std::any_of(spikes.begin(), spikes.end(),
                  [value](const Spike& one) { return one.plateau.value != value; }))
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
bool are_irregular(const std::vector<Spike>& spikes) {
  std::vector<double> heights;
  std::size_t upwards = 0;
  for (const Spike& spike : spikes) {
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
bool step_explains(const Channel& self, const Channel& other, const Spike& spike, double step) {
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

/// How far rows [begin, end) stand out from the rows on both sides; 0 of a step.
double prominence(const Vector& values, Index begin, Index end) {
  const double there = values.segment(begin, end - begin).mean();
  const double up = there - values(begin - 1), down = there - values(end);
  if (up * down <= 0) return 0;
  return std::abs(up) < std::abs(down) ? up : down;
}

/// Without the largest hundredth.
double trimmed_root_mean_square(std::vector<double> values) {
  const double most = quantile(values, 0.99);
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values)
    if (value <= most) sum += value * value, ++count;
  return std::sqrt(sum / double(count));
}

/// Whether another channel answers the spikes together: it stands out with them, in the same row or
/// the next, by more than it does elsewhere.
bool another_answers(const std::vector<Channel>& channels, std::size_t self,
                     const std::vector<Spike>& spikes) {
  const Index rows = channels[self].values.size();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self || !(channels[c].range() > 0)) continue;
    const Vector& values = channels[c].values;
    const Index size = spikes.front().plateau.size();
    std::vector<double> elsewhere;
    const Index stride = std::max<Index>(1, rows / compared_rows);
    for (Index begin = 1; begin + size < rows; begin += stride)
      elsewhere.push_back(std::abs(prominence(values, begin, begin + size)));
    if (elsewhere.empty()) continue;
    const double usual = trimmed_root_mean_square(std::move(elsewhere));
    for (const Index lag : {0, 1}) {
      double sum = 0;
      Index count = 0;
      for (const Spike& spike : spikes) {
        const Index begin = spike.plateau.begin + lag, end = spike.plateau.end + lag;
        if (end >= rows) continue;
        sum += (spike.height > 0 ? 1 : -1) * prominence(values, begin, end);
        ++count;
      }
      if (count > 0 && std::abs(sum) > confirmed_deviations * usual * std::sqrt(double(count)))
        return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Plateau> spikes_of(const std::vector<Channel>& channels, std::size_t self) {
  const Channel& channel = channels[self];
  std::vector<Spike> spikes = outstanding(channel);
  if (spikes.empty()) return {};
  const std::vector<Plateau> plateaus = channel.plateaus();
  const double longest = 2 * median_size(plateaus);
  std::erase_if(spikes, [&](const Spike& one) { return double(one.plateau.size()) > longest; });
  if (spikes.empty()) return {};
  const double share = double(spikes.size()) / double(plateaus.size());
  if (share > (are_irregular(spikes) ? most_irregular : most_spikes) &&
      !are_one_absurd_value(channel, spikes))
    return {};
  std::vector<Spike> alone, beside;  // where no other channel jumps, and where one jumps otherwise
  for (const Spike& spike : spikes) {
    bool jumps = false, explained = false;
    for (std::size_t c = 0; c < channels.size() && !explained; ++c) {
      if (c == self || !(channels[c].range() > 0)) continue;
      const Jump jump = jump_of(channels[c], spike.plateau);
      if (!(jump.size > channels[c].least_jump)) continue;
      jumps = true;
      explained = jump.comes_back || step_explains(channel, channels[c], spike, jump.size);
    }
    if (!explained) (jumps ? beside : alone).push_back(spike);
  }
  double answered = 0;  // height of a spike that may be what the equipment does
  if (!alone.empty() && another_answers(channels, self, alone))
    for (const Spike& spike : std::exchange(alone, {}))
      answered = std::max(answered, 2 * std::abs(spike.height));
  std::vector<Plateau> found;
  for (const Spike& spike : alone) found.push_back(spike.plateau);
  for (const Spike& spike : beside)
    if (std::abs(spike.height) > answered) found.push_back(spike.plateau);
  std::sort(found.begin(), found.end(),
            [](const Plateau& a, const Plateau& b) { return a.begin < b.begin; });
  return found;
}

}  // namespace reident::identification
