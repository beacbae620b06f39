#include "service/judgement/regimes.hpp"

#include <algorithm>
#include <cmath>

#include "service/judgement/scores.hpp"

namespace reident {
namespace {

using storage::Block;

/// Blocks are of one regime where no end of an input's range is further away than this share of
/// the range that the champion has seen.
constexpr double regime_width = 0.25;
/// Ranges of the inputs over the cycle that ends with each block; empty of a block that does not
/// count.
struct InputRange {
  std::vector<double> low, high;

  void widen(const std::vector<double>& other_low, const std::vector<double>& other_high) {
    if (low.empty()) low = other_low, high = other_high;
    for (std::size_t i = 0; i < low.size(); ++i) {
      low[i] = std::min(low[i], other_low[i]);
      high[i] = std::max(high[i], other_high[i]);
    }
  }
  /// Largest distance of an end from the other's, over the range of `all`.
  double distance(const InputRange& other, const InputRange& all) const {
    double largest = 0;
    for (std::size_t i = 0; i < low.size(); ++i)
      if (const double range = all.high[i] - all.low[i]; range > 0)
        largest = std::max({largest, std::abs(low[i] - other.low[i]) / range,
                            std::abs(high[i] - other.high[i]) / range});
    return largest;
  }
};

}  // namespace

std::vector<int> regimes_of(const std::vector<Block>& blocks) {
  std::vector<InputRange> cycles(blocks.size());
  InputRange all;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!counts(blocks[i])) continue;
    all.widen(blocks[i].input_low, blocks[i].input_high);
    for (std::size_t k = i + 1; k-- > 0 && i - k < blocks_of_cycle;)
      if (counts(blocks[k])) cycles[i].widen(blocks[k].input_low, blocks[k].input_high);
  }
  std::vector<const InputRange*> leaders;
  std::vector<int> regimes;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    regimes.push_back(-1);
    if (!counts(blocks[i])) continue;
    double nearest = regime_width;
    for (std::size_t r = 0; r < leaders.size(); ++r)
      if (const double distance = cycles[i].distance(*leaders[r], all); distance < nearest)
        nearest = distance, regimes.back() = static_cast<int>(r);
    if (regimes.back() < 0) {
      regimes.back() = static_cast<int>(leaders.size());
      leaders.push_back(&cycles[i]);
    }
  }
  return regimes;
}

}  // namespace reident
