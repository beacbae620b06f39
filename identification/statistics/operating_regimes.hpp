// Operating regimes of an equipment, by the ranges of its inputs over whole operating cycles.
#pragma once

#include <cstddef>
#include <vector>

namespace reident::identification {

/// Ranges of the inputs over some time; empty over none.
struct InputRanges {
  std::vector<double> low, high;

  /// Whether the other's are not all within.
  bool widen(const InputRanges& other);
  /// Those of the inputs at these places; empty where there are none.
  InputRanges of(const std::vector<std::size_t>& places) const;
};

/// Cycles over which the inputs have about the same ranges are of one regime. A block is of the
/// nearest regime that is near enough to the cycle that ends with it, or begins one. The first
/// blocks, with which no cycle ends, are of the cycle that they are in.
class OperatingRegimes {
 public:
  /// A cycle has so many blocks.
  explicit OperatingRegimes(std::size_t cycle) : cycle_(cycle) {}

  /// Takes in the next block; without ranges it does not count. Returns whether the blocks before
  /// may have other numbers now: what is near depends on the whole range of the inputs.
  bool add(InputRanges block);
  /// The regime of each block, -1 where it does not count.
  const std::vector<int>& numbers() const { return numbers_; }

 private:
  int number_of(const InputRanges& cycle);
  /// Largest distance of the end of a range from the other's, over the whole range.
  double distance(const InputRanges& one, const InputRanges& other) const;

  std::size_t cycle_;
  InputRanges all_;
  std::vector<InputRanges> blocks_, cycles_;  // of each block, and of the cycle that it is of
  std::vector<InputRanges> first_;            // cycle of each regime
  std::vector<int> numbers_;
};

}  // namespace reident::identification
