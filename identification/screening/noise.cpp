#include "identification/screening/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "identification/numerics/cpu_clones.hpp"
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

REIDENT_INLINE Four lesser(Four a, Four b) {
  return a < b ? a : b;
}

REIDENT_INLINE Four greater(Four a, Four b) {
  return a > b ? a : b;
}

/// Four blocks side by side, which begin at `rows[0]` to `rows[3]`: how much a row lies off the
/// middle of its neighbours, as the mean without the rows at which that is most.
REIDENT_CLONES void roughness_of_four(const double* const* rows, double* result) {
  constexpr Index count = noise_block - 2;
  std::array<Four, count> bends;
  std::array<Four, trimmed_rows> largest{};  // ascending
  for (Index i = 0; i < count; ++i) {
    const auto at = [&](Index row) __attribute__((always_inline)) {
      return Four{rows[0][row], rows[1][row], rows[2][row], rows[3][row]};
    };
    const Four off = at(i + 1) - (at(i) + at(i + 2)) / 2.0;
    Four bend = greater(off, -off);
    bends[static_cast<std::size_t>(i)] = bend;
    bend = greater(bend, largest[0]);
    for (std::size_t place = 0; place + 1 < trimmed_rows; ++place) {
      largest[place] = lesser(bend, largest[place + 1]);
      bend = greater(bend, largest[place + 1]);
    }
    largest.back() = bend;
  }
  const Four one = Four{} + 1.0, least = largest[0];
  Four sum{}, kept{};
  for (const Four& bend : bends) {
    sum += bend < least ? bend : Four{};
    kept += bend < least ? one : Four{};
  }
  const Four most_kept = one * double(count - Index(trimmed_rows));
  store(result, (sum + least * (most_kept - kept)) / most_kept);
}

std::vector<double> roughness(const Vector& values, const std::vector<Block>& blocks) {
  constexpr std::size_t lanes = 4;
  std::vector<double> found(blocks.size() + lanes - 1);
  for (std::size_t first = 0; first < blocks.size(); first += lanes) {
    std::array<const double*, lanes> rows;
    for (std::size_t lane = 0; lane < lanes; ++lane)
      rows[lane] = values.data() + blocks[std::min(first + lane, blocks.size() - 1)].begin;
    roughness_of_four(rows.data(), found.data() + first);
  }
  found.resize(blocks.size());
  return found;
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
    ratios[c] = roughness(channel.values, blocks);
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
