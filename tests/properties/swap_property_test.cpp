// A swap in mid-run, over many pairs of versions.
#include <gtest/gtest.h>

#include "tests/support/swap_jump.hpp"

namespace reident::test::swap_property_test {
namespace {

TEST(AnySwap, MovesTheOutputByAtMostThreeTimesTheModelsOwnStep) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const SwapInMidRun swap = swap_in_mid_run(seed);
    EXPECT_LE(swap.jump, 3) << "seed " << seed;
    EXPECT_LE(swap.remaining, 3) << "seed " << seed << " ends as the new version";
  }
}

}  // namespace
}  // namespace reident::test::swap_property_test
