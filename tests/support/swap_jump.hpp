// A swap in the middle of a smooth run, measured.
#pragma once

#include "tests/support/version_pairs.hpp"

namespace reident::test {

/// Both are the largest of the outputs, over the larger of the two models' own change in a step in
/// the neighbourhood, each model as it runs alone on the same inputs.
struct SwapInMidRun {
  double jump;       // change in a step, from the swap to the end of its transition
  double remaining;  // difference from the new model at the end
};

/// Swaps version_pair(seed) on smooth_input().
SwapInMidRun swap_in_mid_run(std::uint64_t seed);

}  // namespace reident::test
