#include "service/satcs/platform/reaction_wheel.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "service/satcs/platform/attitude_loop.hpp"

namespace reident::satcs::platform::reaction_wheel_test {
namespace {

constexpr double step_s = 0.25;

ReactionWheel smooth(double speed_rad_s, WheelConstants constants = {}) {
  constants.ripple = 0;
  return {constants, speed_rad_s, step_s, 1, 1};
}

void run(ReactionWheel& wheel, double command_Nm, double temperature_C, int seconds = 20'000) {
  for (int k = 0; k < 4 * seconds; ++k) wheel.step(command_Nm, 28, temperature_C);
}

TEST(ReactionWheel, SettlesAtTheSpeedWhereFrictionIsTheCommand) {
  for (const double temperature_C : {5.0, 20.0, 35.0}) {
    ReactionWheel wheel = smooth(100);
    run(wheel, 0.009, temperature_C);
    const WheelConstants c;
    const double viscous = c.viscous_Nms * std::exp(c.viscous_per_K * (temperature_C - 20));
    EXPECT_NEAR(wheel.speed_rad_s(), (0.009 - c.coulomb_Nm) / viscous, 0.1) << temperature_C;
    EXPECT_NEAR(wheel.net_Nm(), 0, 1e-6);
  }
}

TEST(ReactionWheel, AnswersATorqueWithItsTimeConstant) {
  WheelConstants c;
  c.coulomb_Nm = c.stribeck_Nm = 0;
  ReactionWheel wheel = smooth(0, c);
  const double time_constant_s = c.inertia_kg_m2 / c.viscous_Nms;
  run(wheel, 0.007, 20, static_cast<int>(time_constant_s));
  EXPECT_NEAR(wheel.speed_rad_s(), 200 * (1 - std::exp(-1)), 1);
}

TEST(ReactionWheel, NeedsMoreTorqueToLeaveRestThanToTurnSlowly) {
  const ReactionWheel wheel = smooth(0);
  EXPECT_EQ(wheel.friction_Nm(0, 20), 0);
  EXPECT_GT(wheel.friction_Nm(2, 20), wheel.friction_Nm(30, 20));
  EXPECT_GT(wheel.friction_Nm(300, 20), wheel.friction_Nm(30, 20));
  EXPECT_EQ(wheel.friction_Nm(-2, 20), -wheel.friction_Nm(2, 20));
  EXPECT_GT(wheel.friction_Nm(200, 0), wheel.friction_Nm(200, 20));
}

TEST(ReactionWheel, IsLimitedInTorqueAndInSpeed) {
  ReactionWheel wheel = smooth(0);
  const WheelConstants c;
  for (int k = 0; k < 40; ++k) wheel.step(1, 28, 20);
  EXPECT_NEAR(wheel.motor_A(), c.current_max_A, 1e-6);
  run(wheel, 1, 20);
  EXPECT_LT(wheel.motor_A(), c.current_max_A);
  EXPECT_LT(wheel.speed_rad_s(), 28 / c.torque_Nm_A);
  EXPECT_GT(wheel.speed_rad_s(), 380);
}

TEST(ReactionWheel, HeatIsWhatItTakesAndDoesNotKeep) {
  ReactionWheel wheel(WheelConstants{}, 150, step_s, 3, 1);
  double taken = 0, heat = 0;
  const double before = wheel.kinetic_J();
  for (int k = 0; k < 40'000; ++k) {
    if (k % 4 == 0) wheel.vary();
    wheel.step(0.03 * std::sin(k * 2e-3), 28, 20);
    taken += step_s * wheel.supply_W();
    heat += step_s * wheel.heat_W();
    ASSERT_GE(wheel.supply_W(), WheelConstants{}.drive_W);
    ASSERT_GT(wheel.heat_W(), 0);
  }
  EXPECT_NEAR(taken - heat, wheel.kinetic_J() - before, 1e-6);
}

TEST(AttitudeLoop, HoldsTheBodyAgainstDisturbancesAndItsWheelsFriction) {
  AttitudeLoop loop({}, step_s, 1, 1);
  ReactionWheel wheel = smooth(200);
  double worst = 0;
  for (int k = 0; k < 4 * 12'000; ++k) {
    if (k % 4 == 0) loop.update(wheel.speed_rad_s());
    wheel.step(loop.command_Nm(0), 28, 20);
    loop.step(1e-3 * std::sin(k * 2.6e-4) + loop.unloading_Nm(), wheel.net_Nm(), 0);
    if (k > 4 * 3000) worst = std::max(worst, std::abs(loop.error_rad()));
  }
  EXPECT_LT(worst, 2e-3);
}

TEST(AttitudeLoop, UnloadsFromTheLimitUntilTheWheelIsNearItsBias) {
  AttitudeLoop loop({}, step_s, 1, 1);
  const AxisConstants c;
  loop.update(c.bias_rad_s + c.unload_from_rad_s - 1);
  EXPECT_EQ(loop.unloading_Nm(), 0);
  loop.update(c.bias_rad_s + c.unload_from_rad_s + 1);
  EXPECT_EQ(loop.unloading_Nm(), -c.unload_Nm);
  loop.update(c.bias_rad_s + c.unload_until_rad_s + 1);
  EXPECT_EQ(loop.unloading_Nm(), -c.unload_Nm);
  loop.update(c.bias_rad_s + c.unload_until_rad_s - 1);
  EXPECT_EQ(loop.unloading_Nm(), 0);
  loop.update(c.bias_rad_s - c.unload_from_rad_s - 1);
  EXPECT_EQ(loop.unloading_Nm(), c.unload_Nm);
}

TEST(SlewPlan, TurnsAndTurnsBackAndRestsInQuietTimes) {
  const reference::Orbit orbit{reference::OrbitConstants{}};
  constexpr storage::Time start = 1'498'867'200'000'000'000;
  const SlewPlan plan(orbit, {}, {}, 3);
  const SlewPlan quiet(orbit, {}, {reference::usual(reference::LifeKind::quiet, start, start)}, 3);
  double rate = 0, angle = 0, most = 0;
  int turning = 0;
  for (int s = 0; s < 20 * 6016; ++s) {
    const double acceleration = plan.acceleration(0, 15, start + s * storage::second_ns);
    EXPECT_EQ(quiet.acceleration(0, 15, start + s * storage::second_ns), 0);
    rate += acceleration;
    angle += rate;
    most = std::max(most, std::abs(angle));
    turning += acceleration != 0;
  }
  EXPECT_GT(turning, 20 * 480);
  EXPECT_LT(most, 18 * 3.14159 / 180);
  EXPECT_GT(most, 8 * 3.14159 / 180);
}

}  // namespace
}  // namespace reident::satcs::platform::reaction_wheel_test
