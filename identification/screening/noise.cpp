#include "identification/screening/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr Index noise_block = 60;
constexpr std::size_t trimmed_rows = 6;  // of a block: the jumps at load steps
constexpr std::size_t least_noisy_blocks = 3;
constexpr double noise_factor = 4;
constexpr double common_noise_factor = 2;
constexpr double noise_deviation_share = 0.02;

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

double roughness(const Vector& values, Index begin) {
  constexpr Index count = noise_block - 2;
  Eigen::Array<double, count, 1> bends;
  const auto rows = values.array();
  bends = (rows.segment<count>(begin + 1) -
           (rows.segment<count>(begin) + rows.segment<count>(begin + 2)) / 2)
              .abs();
  std::array<double, trimmed_rows> largest{};  // ascending
  for (const double bend : bends) {
    if (bend <= largest.front()) continue;
    std::size_t place = 0;
    for (; place + 1 < largest.size() && largest[place + 1] < bend; ++place)
      largest[place] = largest[place + 1];
    largest[place] = bend;
  }
  double sum = 0;
  Index kept = 0;
  for (const double bend : bends) {
    sum += bend < largest.front() ? bend : 0;
    kept += bend < largest.front() ? 1 : 0;
  }
  constexpr Index most_kept = count - Index(trimmed_rows);
  return (sum + largest.front() * double(most_kept - kept)) / double(most_kept);
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

std::vector<NoisyRows> noisy_rows(const std::vector<std::vector<double>>& ratios, std::size_t self,
                                  const std::vector<Block>& blocks, const Record& record) {
  std::vector<NoisyRows> found;
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
    if (end - block >= least_noisy_blocks) {
      // The burst begins and ends within the blocks next to these.
      const Segment& segment = record.segments[blocks[block].segment];
      found.push_back({std::max(blocks[block].begin - noise_block, segment.begin),
                       std::min(blocks[end - 1].begin + 2 * noise_block, segment.end),
                       blocks[block].segment});
    }
    block = std::max(end, block + 1);
  }
  return found;
}

}  // namespace

std::vector<std::vector<NoisyRows>> noise_bursts(const std::vector<Channel>& channels,
                                                 const Record& record) {
  const std::vector<Block> blocks = blocks_of(record);
  const auto ratios = rough_ratios(channels, blocks);
  std::vector<std::vector<NoisyRows>> found(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (!ratios[c].empty()) found[c] = noisy_rows(ratios, c, blocks, record);
  return found;
}

}  // namespace reident::identification
