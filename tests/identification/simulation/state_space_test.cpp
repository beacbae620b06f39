#include "identification/simulation/state_space.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "identification/samples/verdict.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::state_space_test {
namespace {

TEST(StateSpace, SpectralRadiusIsTheLargestModulus) {
  StateSpaceModel model;
  model.A.resize(2, 2);
  model.A << 0.6, 0.8, -0.8, 0.6;
  EXPECT_NEAR(spectral_radius(model), 1, 1e-15);
  model.A.resize(0, 0);
  EXPECT_EQ(spectral_radius(model), 0);
}

TEST(StateSpace, SlowestTimeConstantIsThatOfTheLargestModulus) {
  StateSpaceModel model;
  model.period_s = 8;
  model.A = Vector{{0.5, -std::exp(-0.01)}}.asDiagonal();
  EXPECT_NEAR(slowest_time_constant_s(model), 800, 1e-9);
  model.A.setIdentity();
  EXPECT_EQ(slowest_time_constant_s(model), std::numeric_limits<double>::infinity());
  model.A.setZero();
  EXPECT_EQ(slowest_time_constant_s(model), 0);
}

TEST(StateSpace, StaticGainDoesNotDependOnTheSizeOfStates) {
  test::Noise noise(2);
  const StateSpaceModel model = test::random_system(noise, 4, 2, 2);
  const Vector size{{1e-7, 1e3, 1, 1e7}};
  StateSpaceModel scaled = model;
  scaled.A = size.asDiagonal() * model.A * size.cwiseInverse().asDiagonal();
  scaled.B = size.asDiagonal() * model.B;
  scaled.C = model.C * size.cwiseInverse().asDiagonal();
  const auto gain = static_gain(scaled);
  ASSERT_TRUE(gain);
  EXPECT_LT((*gain - *static_gain(model)).norm(), 1e-9);
}

TEST(StateSpace, StableMeansInsideTheUnitCircle) {
  EXPECT_TRUE(is_stable(Matrix::Identity(2, 2) * 0.999));
  EXPECT_FALSE(is_stable(Matrix::Identity(2, 2)));
  EXPECT_FALSE(is_stable(Matrix::Constant(1, 1, std::numeric_limits<double>::quiet_NaN())));
}

TEST(StateSpace, WellFormedModelsHaveMatchingSizesAndFiniteNumbers) {
  test::Noise noise(1);
  const StateSpaceModel good = test::random_system(noise, 3, 2, 1);
  EXPECT_TRUE(is_well_formed(good));
  const auto broken = [&good](auto&& breaking) {
    StateSpaceModel model = good;
    breaking(model);
    return !is_well_formed(model);
  };
  EXPECT_TRUE(broken([](auto& m) { m.B.conservativeResize(2, 2); }));
  EXPECT_TRUE(broken([](auto& m) { m.C.conservativeResize(1, 2); }));
  EXPECT_TRUE(broken([](auto& m) { m.u0.resize(0); }));
  EXPECT_TRUE(broken([](auto& m) { m.K = Matrix::Zero(1, 3); }));
  EXPECT_TRUE(broken([](auto& m) { m.D(0, 0) = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(broken([](auto& m) { m.period_s = 0; }));
}

TEST(Verdict, CodesHaveTheirPublishedNames) {
  EXPECT_EQ(name(VerdictCode::too_few_samples), "too_few_samples");
  EXPECT_EQ(name(VerdictCode::non_finite), "non_finite");
  EXPECT_EQ(name(VerdictCode::constant_inputs), "constant_inputs");
  EXPECT_EQ(name(VerdictCode::constant_outputs), "constant_outputs");
  EXPECT_EQ(name(VerdictCode::insufficient_excitation), "insufficient_excitation");
  EXPECT_EQ(name(VerdictCode::unstable), "unstable");
  EXPECT_EQ(name(VerdictCode::no_better_than_mean), "no_better_than_mean");
}

TEST(StaticGain, IsWhereAStepResponseEnds) {
  test::Noise noise(1);
  for (const Index order : {1, 4}) {
    const StateSpaceModel model = test::random_system(noise, order, 2, 2, 0.9);
    const auto gain = static_gain(model);
    ASSERT_TRUE(gain.has_value());
    for (Index input = 0; input < 2; ++input) {
      Matrix u = Matrix::Zero(400, 2);
      u.col(input).setOnes();
      const Matrix y = test::simulated(model, u, Vector::Zero(order));
      EXPECT_LT((gain->col(input) - y.bottomRows(1).transpose()).norm(), 1e-9);
    }
  }
}

TEST(StaticGain, IsAbsentOfAnIntegrator) {
  test::Noise noise(1);
  StateSpaceModel model = test::random_system(noise, 1, 1, 1);
  model.A(0, 0) = 1;
  EXPECT_FALSE(static_gain(model).has_value());
}

}  // namespace
}  // namespace reident::identification::state_space_test
