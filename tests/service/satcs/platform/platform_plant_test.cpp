#include "service/satcs/platform/platform_plant.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace reident::satcs::platform::platform_plant_test {
namespace {

using reference::LifeEvent;
using reference::LifeKind;

constexpr storage::Time start = 1'498'867'200'000'000'000;
constexpr int orbit_steps = 6016 * PlatformPlant::usual_steps_per_second;

TEST(PlatformPlant, HeatIsTakenUpEmittedOrStoredInEveryStep) {
  PlatformPlant plant({}, {}, start, 1);
  double stored = plant.thermal().stored_J(), emitted = 0, taken = 0;
  const double before = stored;
  for (int k = 0; k < 2 * orbit_steps; ++k) {
    plant.step();
    const HeatBalance balance = plant.heat_balance();
    ASSERT_NEAR(plant.thermal().stored_J() - stored, balance.stored() * plant.step_s(), 1e-6);
    stored = plant.thermal().stored_J();
    emitted += balance.emitted * plant.step_s();
    taken += (balance.stored() + balance.emitted) * plant.step_s();
  }
  EXPECT_NEAR((taken - emitted) / taken, (stored - before) / taken, 1e-10);
}

TEST(PlatformPlant, ThermostatsHoldTheirNodesBetweenTheThresholds) {
  PlatformPlant plant({}, {}, start, 1);
  const Constants c;
  std::array<int, heater_count> switched{};
  std::array<bool, heater_count> was{};
  for (int k = 0; k < 4 * orbit_steps; ++k) {
    plant.step();
    for (std::size_t h = 0; h < heater_count; ++h) {
      const auto& limits = c.thermal.heater[h].thermostat[0];
      const double node_C = plant.thermal().temperature_C(first_heated + h);
      const bool on = plant.heater_on(h);
      if (k > 0 && on != was[h]) {
        ++switched[h];
        // It switches at its thresholds alone, within what a second can change.
        EXPECT_NEAR(node_C, on ? limits.on_C : limits.off_C, 0.05) << h;
      }
      was[h] = on;
      EXPECT_EQ(plant.heater_A(h) > 0, on);
    }
  }
  for (std::size_t h = 0; h < heater_count; ++h) EXPECT_GE(switched[h], 2) << h;
}

TEST(PlatformPlant, AStuckHeaterWarmsItsTankAboveTheThreshold) {
  PlatformPlant plant({}, {{LifeKind::heater_stuck, start, start, 1, 4}}, start, 1);
  for (int k = 0; k < 3 * orbit_steps; ++k) plant.step();
  EXPECT_GT(plant.thermal().temperature_C(tank), 20);
  EXPECT_GT(plant.heater_A(3), 0.8);
}

TEST(PlatformPlant, ALostHeaterLetsItsTankCool) {
  PlatformPlant plant({}, {{LifeKind::heater_loss, start, start, 1, 4}}, start, 1);
  for (int k = 0; k < 3 * orbit_steps; ++k) plant.step();
  EXPECT_LT(plant.thermal().temperature_C(tank), 8);
  EXPECT_TRUE(plant.heater_on(3));
  EXPECT_EQ(plant.heater_A(3), 0);
}

TEST(PlatformPlant, WheelsTurnTheSpacecraftAndAreUnloaded) {
  PlatformPlant plant({}, {}, start, 1);
  double worst_rad = 0;
  std::array<int, wheel_count> unloads{};
  bool saturated = false;
  for (int k = 0; k < 8 * orbit_steps; ++k) {
    plant.step();
    for (std::size_t a = 0; a < wheel_count; ++a) {
      worst_rad = std::max(worst_rad, std::abs(plant.axis(a).error_rad()));
      unloads[a] += plant.axis(a).unloading_Nm() != 0;
      saturated = saturated || std::abs(plant.wheel(a).motor_A()) >= 2.5;
      ASSERT_LT(std::abs(plant.wheel(a).speed_rad_s()), 400);
    }
  }
  EXPECT_LT(worst_rad, 0.02);
  EXPECT_FALSE(saturated);
  for (const int steps : unloads) EXPECT_GT(steps, 0);
}

TEST(PlatformPlant, WornOutPlatformStaysFinite) {
  PlatformPlant plant({},
                      {{LifeKind::paint_degradation, start, start, 0.6, 0},
                       {LifeKind::heater_stuck, start, start, 1, 0},
                       {LifeKind::bearing_wear, start, start, 5, 0},
                       {LifeKind::motor_fade, start, start, 0.5, 0},
                       {LifeKind::interface_loss, start, start, 0.9, 0},
                       {LifeKind::gain_drop, start, start, 10, 0}},
                      start, 1);
  for (int k = 0; k < 4 * orbit_steps; ++k) {
    plant.step();
    for (std::size_t node = 0; node < node_count; ++node)
      ASSERT_LT(std::abs(plant.thermal().temperature_C(node)), 150) << node;
    for (std::size_t w = 0; w < wheel_count; ++w)
      ASSERT_LT(std::abs(plant.wheel(w).speed_rad_s()), 500) << w;
  }
}

}  // namespace
}  // namespace reident::satcs::platform::platform_plant_test
