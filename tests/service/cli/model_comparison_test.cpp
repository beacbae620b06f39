#include "service/cli/model_comparison.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "identification/simulation/free_run.hpp"

namespace reident::cli::model_comparison_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::StateSpaceModel;
using identification::Vector;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A real pole at 0.9 and a pair of modulus 0.8 at an eighth of a turn; period 2 s.
EquipmentModel model() {
  const double c = 0.8 * std::numbers::sqrt2 / 2;
  EquipmentModel result;
  result.inputs = {{"u", "V", 0, 1}, {"v", "A", 0, 1}};
  result.outputs = {{"y", "V", 0, 1}, {"z", "W", 0, 1}};
  result.dynamics.A = Matrix{{0.9, 0.3, 0}, {0, c, c}, {0, -c, c}};
  result.dynamics.B = Matrix{{1, 0.5}, {0.2, -1}, {0, 0.3}};
  result.dynamics.C = Matrix{{1, 0, 0.4}, {-0.3, 1, 0}};
  result.dynamics.D = Matrix{{0.1, 0}, {0, -2}};
  result.dynamics.u0 = Vector{{3, 4}};
  result.dynamics.y0 = Vector{{20, 30}};
  result.dynamics.period_s = 2;
  return result;
}

/// Outputs of the simulated matrices after a step of 1 at the first sample, less the operating
/// point.
Matrix simulated_step(const StateSpaceModel& dynamics, Index input, Index samples) {
  Matrix u = dynamics.u0.transpose().replicate(samples, 1);
  u.col(input).array() += 1;
  const auto record = identification::contiguous_record(dynamics.period_s, u,
                                                        Matrix::Zero(samples, dynamics.outputs()));
  const Vector rest = Vector::Zero(dynamics.order());
  return free_run(dynamics, record, record.all(), rest).rowwise() - dynamics.y0.transpose();
}

TEST(Poles, HaveTheTimeConstantOfTheirDecayAndTheFrequencyOfTheirTurn) {
  const auto poles = poles_of(model().dynamics);
  ASSERT_THAT(poles, SizeIs(2)) << "the pair once";
  EXPECT_NEAR(poles[0].value.real(), 0.9, 1e-12);
  EXPECT_NEAR(poles[0].time_constant_s, -2 / std::log(0.9), 1e-9);
  EXPECT_EQ(poles[0].frequency_hz, 0);
  EXPECT_NEAR(std::abs(poles[1].value), 0.8, 1e-12);
  EXPECT_GT(poles[1].value.imag(), 0);
  EXPECT_NEAR(poles[1].time_constant_s, -2 / std::log(0.8), 1e-9);
  EXPECT_NEAR(poles[1].frequency_hz, 1. / 16, 1e-12);
}

TEST(Poles, OfAStaticModelAreNoneAndOfAnIntegratorNeverDecay) {
  StateSpaceModel dynamics = model().dynamics;
  dynamics.A = Matrix::Identity(3, 3);
  EXPECT_TRUE(std::isinf(poles_of(dynamics)[0].time_constant_s));
  dynamics.A.resize(0, 0);
  EXPECT_THAT(poles_of(dynamics), IsEmpty());
}

TEST(StepResponse, IsWhatTheMatricesGiveWhenTheyAreSimulated) {
  const StateSpaceModel dynamics = model().dynamics;
  const std::vector<double> times = {0, 2, 4, 7, 100};
  for (Index input = 0; input < 2; ++input) {
    const Matrix response = step_response(dynamics, input, times);
    const Matrix simulated = simulated_step(dynamics, input, 51);
    for (std::size_t i = 0; i < times.size(); ++i)
      EXPECT_LT((response.col(static_cast<Index>(i)) -
                 simulated.row(static_cast<Index>(times[i] / 2)).transpose())
                    .norm(),
                1e-10)
          << times[i];
  }
}

TEST(StepTimes, ReachUntilTheSlowerModelHasSettled) {
  StateSpaceModel slow = model().dynamics, fast = slow;
  fast.A *= 0.1;
  // 0.9^44 < 0.01: 88 s
  EXPECT_THAT(step_times(fast, slow), ElementsAre(0, 2, 4, 10, 20, 40, 100));
  fast.period_s = 1;
  EXPECT_EQ(step_times(fast, slow)[1], 1);
}

TEST(Comparison, OfAModelWithItselfFindsNoDifference) {
  const ModelComparison comparison = compare_models(model(), 1, model(), 2);
  EXPECT_THAT(comparison.input_differences, IsEmpty());
  ASSERT_THAT(comparison.channels, SizeIs(4));
  for (const Channel& channel : comparison.channels) {
    EXPECT_EQ(channel.gain_a, channel.gain_b);
    EXPECT_EQ(channel.steps_a, channel.steps_b);
    EXPECT_THAT(channel.steps_a, SizeIs(comparison.times_s.size()));
  }
}

TEST(Comparison, NamesTheInputsThatDifferAndKeepsTheCommonOnesTogether) {
  EquipmentModel a = model(), b = model();
  b.inputs[0] = {"P", "W", 0, 1, "a * i"};
  b.inputs[1].unit = "mA";
  const ModelComparison comparison = compare_models(a, 3, b, 5);
  EXPECT_THAT(comparison.input_differences,
              ElementsAre("only version 3 has u", "version 3 has v [A] and version 5 has v [mA]",
                          "only version 5 has P = a * i"));
  ASSERT_THAT(comparison.channels, SizeIs(6));
  EXPECT_EQ(comparison.channels[0].input, "u");
  EXPECT_FALSE(comparison.channels[0].gain_b);
  EXPECT_TRUE(comparison.channels[2].gain_a && comparison.channels[2].gain_b);
  EXPECT_EQ(comparison.channels[4].input, "P");
  EXPECT_FALSE(comparison.channels[4].gain_a);
}

}  // namespace
}  // namespace reident::cli::model_comparison_test
