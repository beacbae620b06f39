#include "service/judgement/offset.hpp"

#include <cmath>
#include <deque>
#include <tuple>

#include <gmock/gmock.h>

namespace reident::offset_test {
namespace {

using storage::BlockScore;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

/// A block with one output: mean and mean square of the error, the sensor's mean, the square of its
/// effect and the product of effect and error.
BlockScore score(double mean, double square, std::vector<double> effect) {
  BlockScore found;
  found.rows = 100;
  found.mean = {mean};
  found.square = {square};
  found.bias_effects = std::move(effect);
  return found;
}

/// A sensor whose mean is `mean` and its phase, in so many cycles, 1 more in each second one.
SensorPast past(double mean, std::size_t cycles) {
  std::deque<BlockScore> blocks;
  PhasedScores scores;
  for (std::size_t i = 0; i < cycles * blocks_of_cycle; ++i) {
    const std::size_t phase = i % blocks_of_cycle;
    const double more = i / blocks_of_cycle % 2 == 0 ? 0 : 1;
    blocks.push_back(score(0, 1, {mean + double(phase) + more, 1, 0}));
    scores.emplace_back(phase, &blocks.back());
  }
  return {0, 1, scores};
}

TEST(Offset, TheSpreadOfASensorIsThatOfItsCycles) {
  EXPECT_NEAR(past(5, 100).spread(), 0.5, 0.01);
  EXPECT_NEAR(past(5, 100).departure(2, score(0, 1, {9, 1, 0})), 9 - 7.5, 1e-9);
  EXPECT_TRUE(std::isinf(past(5, 7).spread())) << "less than eight cycles say nothing";
}

TEST(Offset, AConstantExplainsTheMean) {
  OffsetFit fit(std::size_t{0});
  fit.add(0, score(2, 5, {}));
  fit.add(1, score(4, 17, {}));
  EXPECT_THAT(fit.rest(score(2, 5, {})), ElementsAre(DoubleNear(2, 1e-9)));
  EXPECT_NEAR(fit.offset(), 3, 1e-9);
}

TEST(Offset, TheOutputWhoseErrorItExplainsMostSaysHowLargeItIs) {
  // An offset of 1 explains a hundredth of the first output's error, one of 4 all of the second's.
  BlockScore two = score(0, 100, {5, 1, -1, 1, -4});
  two.mean = {0, 0};
  two.square = {100, 16};
  const SensorPast unknown = past(5, 7);
  OffsetFit fit(unknown, 0);
  fit.add(0, two);
  EXPECT_NEAR(fit.offset(), 4, 1e-9);
}

TEST(Offset, ASensorsEffectExplainsWhatItsPastAndTheDirectionAllow) {
  // The error is -10 times the effect: an offset of 10 makes it, and one of 1.5 leaves 8.5 times.
  for (const auto& [moved, direction, rest] :
       {std::tuple(10.0, 0, 0.0), {0.0, 0, 8.5 * 8.5}, {10.0, 1, 0.0}, {10.0, -1, 100.0}}) {
    const SensorPast known = past(5, 100);
    OffsetFit fit(known, direction);
    const BlockScore block = score(0, 100, {5.5 + moved, 1, -10});
    fit.add(0, block);
    EXPECT_THAT(fit.rest(block), ElementsAre(DoubleNear(rest, 0.6))) << moved << ' ' << direction;
  }
}

TEST(Offset, ASensorWhoseCyclesAreAllAlikeIsOffByWhatItDeparts) {
  std::deque<BlockScore> blocks;
  PhasedScores scores;
  for (std::size_t i = 0; i < 10 * blocks_of_cycle; ++i) {
    blocks.push_back(score(0, 1, {5, 1, 0}));
    scores.emplace_back(i % blocks_of_cycle, &blocks.back());
  }
  const SensorPast constant(0, 1, scores);
  ASSERT_EQ(constant.spread(), 0);
  for (const int direction : {0, 1}) {
    OffsetFit fit(constant, direction);
    fit.add(0, score(0, 4, {7, 1, -2}));
    EXPECT_EQ(fit.offset(), 2) << direction;
  }
}

TEST(Offset, ABlockWithoutTheEffectSaysNothing) {
  const SensorPast known = past(5, 100);
  const BlockScore block = score(0, 4, {7.5, 1, -2});
  OffsetFit fit(known, 0);
  fit.add(0, block);
  fit.add(1, score(0, 4, {}));
  EXPECT_THAT(fit.rest(block), ElementsAre(DoubleNear(0, 0.03)));
  EXPECT_NEAR(fit.offset(), 2, 0.2);
}

}  // namespace
}  // namespace reident::offset_test
