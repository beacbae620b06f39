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
constexpr double steady = 0.5;  // the median of noise is more of the mean

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

/// The roughness of each block of a channel over the usual one; none where it is not judged.
struct Roughness {
  std::vector<double> ratios;
  double usual = 0;
};

std::vector<Roughness> rough_ratios(const std::vector<Channel>& channels,
                                    const std::vector<Block>& blocks) {
  std::vector<Roughness> found(channels.size());
  if (blocks.empty()) return found;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Channel& channel = channels[c];
    if (!channel.is_analog || !(channel.range() > 0)) continue;
    auto& [ratios, usual] = found[c];
    ratios = roughness(channel.values, blocks);
    const Vector& values = channel.values;
    const double deviation = std::sqrt((values.array() - values.mean()).square().mean());
    usual = std::max(quantile(ratios, 0.75), noise_deviation_share / noise_factor * deviation);
    for (double& ratio : ratios) ratio /= usual;
  }
  return found;
}

/// Whether most rows of these blocks lie far less off the middle of their neighbours than the mean
/// of them, as those of a channel do that steps between levels.
bool steps_there(const Vector& values, const std::vector<Block>& blocks, const Roughness& rough,
                 std::size_t begin, std::size_t end) {
  std::vector<double> bends;
  double mean = 0;
  for (std::size_t block = begin; block < end; ++block) {
    const Index first = blocks[block].begin;
    for (Index row = first + 1; row + 1 < first + noise_block; ++row)
      bends.push_back(std::abs(values(row) - (values(row - 1) + values(row + 1)) / 2));
    mean += rough.ratios[block] * rough.usual / double(end - begin);
  }
  return quantile(bends, 0.5) < steady * mean;
}

std::vector<NoisyRows> noisy_rows(const std::vector<Channel>& channels,
                                  const std::vector<Roughness>& rough, std::size_t self,
                                  const std::vector<Block>& blocks, const Record& record) {
  std::vector<NoisyRows> found;
  const auto is_noisy = [&](std::size_t block) {
    if (!(rough[self].ratios[block] > noise_factor)) return false;
    for (std::size_t c = 0; c < rough.size(); ++c)
      if (c != self && !rough[c].ratios.empty() && rough[c].ratios[block] > common_noise_factor)
        return false;
    return true;
  };
  for (std::size_t block = 0; block < blocks.size();) {
    std::size_t end = block;
    while (end < blocks.size() && blocks[end].segment == blocks[block].segment && is_noisy(end))
      ++end;
    if (end - block >= least_noisy_blocks &&
        !steps_there(channels[self].values, blocks, rough[self], block, end)) {
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
  const auto rough = rough_ratios(channels, blocks);
  std::vector<std::vector<NoisyRows>> found(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (!rough[c].ratios.empty()) found[c] = noisy_rows(channels, rough, c, blocks, record);
  return found;
}

}  // namespace reident::identification
