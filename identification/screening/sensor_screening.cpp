#include "identification/screening/sensor_screening.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

namespace reident::identification {
namespace {

constexpr Index least_stuck_rows = 60;
constexpr double stuck_factor = 5;
constexpr std::size_t most_stuck = 3;  // plateaus of one channel
constexpr double repeated_share = 1.0 / 3;
/// What another channel moves meanwhile, as a share of its range.
constexpr double moving_share = 0.1;

constexpr double spike_steps = 20;
constexpr double spike_range_share = 0.05;
constexpr double neighbours_agree = 0.3;
constexpr double most_spikes = 0.02;

constexpr Index noise_block = 60;
constexpr Index trimmed_rows = 6;  // of a block: the jumps at load steps
constexpr std::size_t least_noisy_blocks = 3;
constexpr double noise_factor = 4;
constexpr double common_noise_factor = 2;
constexpr double noise_deviation_share = 0.02;

/// Rows [begin, end) of one segment in which a channel repeats one value.
struct Plateau {
  Index begin = 0, end = 0;
  double value = 0;
  std::size_t segment = 0;
  Index size() const { return end - begin; }
};

struct Channel {
  Eigen::Ref<const Vector> values;
  bool is_analog = false;
  double low = 0, high = 0;
  std::vector<Plateau> plateaus;
  double least_jump = 0;  // of analog channels; any change of the others is one

  double range() const { return high - low; }
};

std::vector<Plateau> plateaus_of(const Eigen::Ref<const Vector>& values,
                                 const std::vector<Segment>& segments) {
  std::vector<Plateau> plateaus;
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (Index row = segments[s].begin; row < segments[s].end; ++row) {
      if (row == segments[s].begin || values(row) != plateaus.back().value)
        plateaus.push_back({row, row, values(row), s});
      plateaus.back().end = row + 1;
    }
  return plateaus;
}

TickRange ticks_of(const Record& record, std::size_t segment, Index begin, Index end) {
  const Segment& within = record.segments[segment];
  const std::int64_t first = within.first_tick + (begin - within.begin);
  return {first, first + (end - begin)};
}

bool another_moves(const std::vector<Channel>& channels, std::size_t self, const Plateau& plateau) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self || !channels[c].is_analog) continue;
    // Its middle: where it began and ended, the channel stood still for other reasons.
    const auto there =
        channels[c].values.segment(plateau.begin + plateau.size() / 4, plateau.size() / 2);
    if (there.maxCoeff() - there.minCoeff() > moving_share * channels[c].range()) return true;
  }
  return false;
}

bool is_repeated_elsewhere(const std::vector<Plateau>& plateaus, const Plateau& plateau) {
  const double least = repeated_share * double(plateau.size());
  return std::any_of(plateaus.begin(), plateaus.end(), [&](const Plateau& other) {
    return other.begin != plateau.begin && other.value == plateau.value &&
           double(other.size()) >= least;
  });
}

std::vector<Plateau> stuck_plateaus(const std::vector<Channel>& channels, std::size_t self) {
  const Channel& channel = channels[self];
  std::vector<Plateau> longest = channel.plateaus;
  const std::size_t looked_at = std::min(longest.size(), most_stuck + 1);
  std::partial_sort(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(looked_at),
                    longest.end(), [](const Plateau& a, const Plateau& b) {
                      return a.size() != b.size() ? a.size() > b.size() : a.begin < b.begin;
                    });
  if (looked_at <= most_stuck) return {};  // hardly any samples to compare with
  const double usual = double(longest[most_stuck].size());
  std::vector<Plateau> stuck;
  for (std::size_t i = 0; i < most_stuck; ++i) {
    const Plateau& plateau = longest[i];
    if (plateau.size() < least_stuck_rows || double(plateau.size()) < stuck_factor * usual) break;
    if (plateau.value == channel.low || plateau.value == channel.high) continue;
    if (is_repeated_elsewhere(channel.plateaus, plateau) || !another_moves(channels, self, plateau))
      continue;
    stuck.push_back(plateau);
  }
  std::sort(stuck.begin(), stuck.end(),
            [](const Plateau& a, const Plateau& b) { return a.begin < b.begin; });
  return stuck;
}

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// The least change from one value to the next that is no usual one.
double least_jump(const Channel& channel) {
  const std::vector<Plateau>& plateaus = channel.plateaus;
  std::vector<double> steps;
  for (std::size_t i = 1; i < plateaus.size(); ++i)
    if (plateaus[i].segment == plateaus[i - 1].segment)
      steps.push_back(std::abs(plateaus[i].value - plateaus[i - 1].value));
  const double usual = steps.empty() ? 0 : quantile(std::move(steps), 0.5);
  return std::max(spike_steps * usual, spike_range_share * channel.range());
}

/// Whether another channel jumps next to the spike, so that it may be what the equipment does then.
bool another_jumps(const std::vector<Channel>& channels, std::size_t self, const Plateau& spike) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (c == self || !(channels[c].range() > 0)) continue;
    const auto there = channels[c].values.segment(spike.begin - 1, spike.size() + 2);
    if (there.maxCoeff() - there.minCoeff() > channels[c].least_jump) return true;
  }
  return false;
}

/// Plateaus that stand out from both neighbours.
std::vector<Plateau> spikes_of(const Channel& channel) {
  const std::vector<Plateau>& plateaus = channel.plateaus;
  std::vector<double> lengths;
  for (const Plateau& plateau : plateaus) lengths.push_back(double(plateau.size()));
  if (plateaus.size() < 3) return {};
  const double least = channel.least_jump;
  const double longest = 2 * quantile(lengths, 0.5);
  std::vector<Plateau> spikes;
  for (std::size_t i = 1; i + 1 < plateaus.size(); ++i) {
    const Plateau &before = plateaus[i - 1], &plateau = plateaus[i], &after = plateaus[i + 1];
    if (before.segment != plateau.segment || after.segment != plateau.segment) continue;
    const double up = plateau.value - before.value, down = plateau.value - after.value;
    const double height = std::min(std::abs(up), std::abs(down));
    if (up * down > 0 && height > least && double(plateau.size()) <= longest &&
        std::abs(after.value - before.value) < neighbours_agree * height)
      spikes.push_back(plateau);
  }
  if (double(spikes.size()) > most_spikes * double(plateaus.size())) return {};
  return spikes;
}

/// Blocks of rows that lie within one segment.
struct Block {
  Index begin = 0;
  std::size_t segment = 0;
};

std::vector<Block> blocks_of(const Record& record) {
  std::vector<Block> blocks;
  for (std::size_t s = 0; s < record.segments.size(); ++s) {
    const Segment& segment = record.segments[s];
    for (Index begin = segment.begin; begin + noise_block <= segment.end; begin += noise_block)
      blocks.push_back({begin, s});
  }
  return blocks;
}

double roughness(const Eigen::Ref<const Vector>& values, Index begin) {
  std::array<double, noise_block - 2> bends;
  for (Index k = 0; k < noise_block - 2; ++k)
    bends[static_cast<std::size_t>(k)] =
        std::abs(values(begin + k + 1) - (values(begin + k) + values(begin + k + 2)) / 2);
  const auto kept = bends.end() - trimmed_rows;
  std::nth_element(bends.begin(), kept, bends.end());
  return std::accumulate(bends.begin(), kept, 0.0) / double(kept - bends.begin());
}

/// The roughness of each block of each channel over the usual one; empty where the channel is not
/// judged.
std::vector<std::vector<double>> rough_ratios(const std::vector<Channel>& channels,
                                              const std::vector<Block>& blocks) {
  std::vector<std::vector<double>> ratios(channels.size());
  if (blocks.empty()) return ratios;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Channel& channel = channels[c];
    if (!channel.is_analog || !(channel.range() > 0)) continue;
    for (const Block& block : blocks) ratios[c].push_back(roughness(channel.values, block.begin));
    const Vector& values = channel.values;
    const double deviation = std::sqrt((values.array() - values.mean()).square().mean());
    const double usual =
        std::max(quantile(ratios[c], 0.75), noise_deviation_share / noise_factor * deviation);
    for (double& ratio : ratios[c]) ratio /= usual;
  }
  return ratios;
}

std::vector<RowRange> noisy_ranges(const std::vector<std::vector<double>>& ratios, std::size_t self,
                                   const std::vector<Block>& blocks) {
  std::vector<RowRange> found;
  const auto is_noisy = [&](std::size_t block) {
    if (!(ratios[self][block] > noise_factor)) return false;
    for (std::size_t c = 0; c < ratios.size(); ++c)
      if (c != self && !ratios[c].empty() && ratios[c][block] > common_noise_factor) return false;
    return true;
  };
  for (std::size_t block = 0; block < blocks.size();) {
    std::size_t end = block;
    while (end < blocks.size() && blocks[end].segment == blocks[block].segment && is_noisy(end))
      ++end;
    if (end - block >= least_noisy_blocks)
      // The burst begins and ends within the blocks next to these.
      found.push_back({blocks[block].begin - noise_block, blocks[end - 1].begin + 2 * noise_block});
    block = std::max(end, block + 1);
  }
  return found;
}

}  // namespace

std::string_view name(SensorFaultKind kind) {
  switch (kind) {
    case SensorFaultKind::stuck:
      return "stuck";
    case SensorFaultKind::spike:
      return "spike";
    case SensorFaultKind::noise:
      break;
  }
  return "noise";
}

std::vector<SensorFault> sensor_faults(const Record& record, const std::vector<bool>& analog) {
  const Index inputs = record.u.cols(), outputs = record.y.cols();
  assert(static_cast<Index>(analog.size()) == inputs + outputs);
  std::vector<SensorFault> faults;
  if (record.rows() == 0) return faults;
  std::vector<Channel> channels;
  for (Index c = 0; c < inputs + outputs; ++c) {
    const auto values = c < inputs ? record.u.col(c) : record.y.col(c - inputs);
    channels.push_back(
        {values, analog[static_cast<std::size_t>(c)], values.minCoeff(), values.maxCoeff(), {}, 0});
    Channel& channel = channels.back();
    if (!channel.is_analog) continue;
    channel.plateaus = plateaus_of(values, record.segments);
    channel.least_jump = least_jump(channel);
  }
  const std::vector<Block> blocks = blocks_of(record);
  const auto ratios = rough_ratios(channels, blocks);

  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!channels[c].is_analog) continue;
    const auto add = [&](SensorFaultKind kind, TickRange ticks) {
      faults.push_back({kind, static_cast<Index>(c), ticks});
    };
    for (const Plateau& plateau : stuck_plateaus(channels, c))
      add(SensorFaultKind::stuck, ticks_of(record, plateau.segment, plateau.begin, plateau.end));
    for (const Plateau& spike : spikes_of(channels[c]))
      if (!another_jumps(channels, c, spike))
        add(SensorFaultKind::spike, ticks_of(record, spike.segment, spike.begin, spike.end));
    if (ratios[c].empty()) continue;
    for (const RowRange& rows : noisy_ranges(ratios, c, blocks)) {
      const auto segment = std::partition_point(
          record.segments.begin(), record.segments.end(),
          [&](const Segment& one) { return one.end <= rows.begin + noise_block; });
      const Index begin = std::max(rows.begin, segment->begin);
      const Index end = std::min(rows.end, segment->end);
      add(SensorFaultKind::noise,
          ticks_of(record, static_cast<std::size_t>(segment - record.segments.begin()), begin,
                   end));
    }
  }
  return faults;
}

}  // namespace reident::identification
