#include "identification/statistics/error_growth.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::test::error_growth_test {
namespace {

using identification::BlockError;
using identification::ErrorGrowth;

constexpr identification::Index phases = 4;

/// Errors that wander: their logarithm is autoregressive over `memory` blocks.
class Wandering {
 public:
  Wandering(std::uint64_t seed, double memory) : noise_(seed), kept_(std::exp(-1 / memory)) {}
  BlockError next(double growth = 0) {
    state_ = kept_ * state_ + std::sqrt(1 - kept_ * kept_) * noise_.normal();
    return {block_++ % phases, 0.3 * state_ + growth, 0, 1};
  }

 private:
  Noise noise_;
  double kept_;
  double state_ = 0;
  identification::Index block_ = 0;
};

TEST(ErrorGrowth, IsFoundRarelyInALongRecordThatWanders) {
  constexpr int records = 200;
  int calm = 0, alarms = 0, found = 0;
  for (std::uint64_t seed = 0; seed < records; ++seed) {
    Wandering errors(seed, 12);
    ErrorGrowth growth(phases);
    int block = 0;
    while (block < 128 && !growth.add(errors.next())) ++block;
    if (block < 128) continue;
    ++calm;
    while (block < 600 && !growth.add(errors.next())) ++block;
    if (block < 600) {
      ++alarms;
      continue;
    }
    while (block < 700 && !growth.add(errors.next(1.1))) ++block;
    found += block < 700;
  }
  EXPECT_GT(calm, records / 2);
  EXPECT_LT(10 * alarms, calm) << "35 of 100, were the first eight cycles the reference for ever";
  EXPECT_GT(2 * found, calm - alarms) << found;
}

TEST(ErrorGrowth, IsWhatThePhaseAndTheOutputsDoNotExplain) {
  Noise noise(1);
  ErrorGrowth growth(phases);
  for (int block = 0; block < 800; ++block) {
    const double size = noise.normal();
    EXPECT_FALSE(
        growth.add({block % phases, (block % phases) + size + 0.2 * noise.normal(), size, 1}));
  }
  int block = 0;
  while (block < 40 &&
         !growth.add({block % phases, (block % phases) + 0.7 + 0.2 * noise.normal(), 0, 1}))
    ++block;
  EXPECT_LT(block, 20);
}

}  // namespace
}  // namespace reident::test::error_growth_test
