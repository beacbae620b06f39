#include "service/windows/member_run.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"

namespace reident::test::member_run_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;

constexpr Index block_rows = 25;

/// A slow model of first order, with an input that steps.
EquipmentModel model() {
  EquipmentModel result;
  result.dynamics.A = Matrix::Constant(1, 1, 0.95);
  result.dynamics.B = Matrix::Constant(1, 1, 0.1);
  result.dynamics.C = Matrix::Constant(1, 1, 1);
  result.dynamics.D = Matrix::Zero(1, 1);
  result.dynamics.u0 = Vector::Zero(1);
  result.dynamics.y0 = Vector::Constant(1, 5);
  result.dynamics.period_s = 1;
  return result;
}

/// Rows of the model's own output with `offset` added, of the block `number` and of the one before.
BlockSamples samples_of(int number, double offset) {
  const Index rows = (number + 1) * block_rows;
  identification::Record all;
  all.period_s = 1;
  all.u = Matrix(rows, 1);
  for (Index k = 0; k < rows; ++k) all.u(k, 0) = k / 7 % 2 == 0 ? 0 : 1;
  all.y = Matrix::Zero(rows, 1);
  all.segments = {{0, rows, 0}};
  all.y = free_run(model().dynamics, all, all.all(), Vector::Zero(1));
  all.y.array() += offset;
  BlockSamples samples;
  const Index begin = std::max<Index>(0, (number - 1) * block_rows);
  samples.record.period_s = 1;
  samples.record.u = all.u.bottomRows(rows - begin);
  samples.record.y = all.y.bottomRows(rows - begin);
  samples.record.segments = {{0, rows - begin, begin}};
  samples.first_row = number * block_rows - begin;
  samples.block.range = {number * block_rows, rows};
  samples.block.rows = block_rows;
  return samples;
}

TEST(MemberRun, OfTheTrueModelErrsByWhatIsAdded) {
  storage::RunState state;
  for (int number = 0; number < 8; ++number) {
    const storage::BlockScore score = score_block(model(), 3, samples_of(number, 0.5), state);
    state = score.state;
    if (number < 4) continue;  // the first state was estimated from rows with the offset
    EXPECT_EQ(score.version, 3);
    EXPECT_NEAR(score.mean.at(0), 0.5, 0.1) << number;
    EXPECT_NEAR(score.square.at(0), 0.25, 0.1) << number;
  }
}

TEST(MemberRun, GoesOnWithoutABreakFromItsState) {
  storage::RunState state;
  for (int number = 0; number < 3; ++number)
    state = score_block(model(), 1, samples_of(number, 0), state).state;
  const BlockSamples last = samples_of(3, 0);
  const storage::BlockScore score = score_block(model(), 1, last, state);
  EXPECT_LT(score.square.at(0), 1e-20) << "of its own output nothing is left";
  ASSERT_TRUE(score.state.tick);
  EXPECT_EQ(*score.state.tick, 4 * block_rows);
  EXPECT_EQ(score.state.rows, 4 * block_rows);
}

TEST(MemberRun, SaysWhatABiasOfASensorDoesToIt) {
  // The sensor drives the input with a gain of 3, and its effect is to be seen without an error.
  BlockSamples samples = samples_of(1, 0);
  samples.bias_effects = {samples.record};
  samples.bias_effects[0].u.setConstant(3);
  samples.bias_effects[0].y.setConstant(7);
  storage::RunState state = score_block(model(), 1, samples_of(0, 0), {}).state;
  storage::BlockScore score = score_block(model(), 1, samples, state);
  const double gain = 0.1 / (1 - 0.95);
  ASSERT_EQ(score.bias_effects.size(), 3U);
  EXPECT_EQ(score.bias_effects[0], 7);
  EXPECT_NEAR(score.bias_effects[1], 9 * gain * gain, 1e-9);
  EXPECT_NEAR(score.bias_effects[2], 0, 1e-9);
  samples.record.y.array() += 0.5;
  score = score_block(model(), 1, samples, state);
  EXPECT_NEAR(score.bias_effects[2], 3 * gain * 0.5, 1e-9);
  EXPECT_EQ(bias_effect_in(score, 0, 1), score.bias_effects.data());
  EXPECT_EQ(bias_effect_in(score, 0, 2), nullptr) << "rows of other biases";
  EXPECT_EQ(bias_effect_in({}, 0, 1), nullptr);
}

TEST(MemberRun, IsDrivenByWhatABiasDoesToItsInputRowByRow) {
  // The sensor has it where the input is 1 alone, so that the model's response is its own output.
  BlockSamples samples = samples_of(1, 0);
  samples.bias_effects = {samples.record};
  samples.bias_effects[0].y.setZero();
  const storage::RunState state = score_block(model(), 1, samples_of(0, 0), {}).state;
  samples.record.y.array() += 0.5;
  const storage::BlockScore score = score_block(model(), 1, samples, state);
  const double usual = samples.record.u.mean(), steady = 0.1 * usual / (1 - 0.95);
  EquipmentModel plain = model();
  plain.dynamics.y0.setZero();
  const Vector effect =
      free_run(plain.dynamics, samples.record, samples.record.all(), Vector::Constant(1, steady))
          .col(0)
          .tail(block_rows);
  EXPECT_NEAR(score.bias_effects.at(1), effect.squaredNorm() / block_rows, 1e-9);
  EXPECT_NEAR(score.bias_effects.at(2), 0.5 * effect.mean(), 1e-9);
}

TEST(MemberRun, OfABlockWithoutSamplesHasNoRowsAndKeepsItsState) {
  const storage::RunState state = score_block(model(), 1, samples_of(0, 0), {}).state;
  const storage::BlockScore score = score_block(model(), 1, {}, state);
  EXPECT_EQ(score.rows, 0);
  EXPECT_EQ(score.state.tick, state.tick);
  EXPECT_EQ(score.state.x, state.x);
}

}  // namespace
}  // namespace reident::test::member_run_test
