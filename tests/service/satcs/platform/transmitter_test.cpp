#include "service/satcs/platform/transmitter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace reident::satcs::platform::transmitter_test {
namespace {

constexpr storage::Time start = 1'498'867'200'000'000'000;

/// An amplifier that has run for ten minutes.
Transmitter warm(double drive_mW, double case_C) {
  Transmitter transmitter({}, 0.25);
  for (int k = 0; k < 2400; ++k) transmitter.step(drive_mW, case_C);
  return transmitter;
}

TEST(Transmitter, GivesLessWhenItIsWarmAndSaturates) {
  EXPECT_NEAR(warm(1, 25).output_W(), 5.0, 0.1);  // 37 dB
  EXPECT_NEAR(warm(1, 45).output_W() / warm(1, 25).output_W(), std::pow(10, -0.06), 0.01);
  EXPECT_LT(warm(16, 25).output_W(), AmplifierConstants{}.saturation_W);
  EXPECT_LT(warm(16, 25).output_W() / warm(8, 25).output_W(), 1.4);
}

TEST(Transmitter, TakesNothingWhenOffAndStartsWithLessGain) {
  Transmitter transmitter({}, 0.25);
  transmitter.step(0, 10);
  EXPECT_FALSE(transmitter.on());
  EXPECT_EQ(transmitter.supply_W(), 0);
  EXPECT_EQ(transmitter.output_W(), 0);
  transmitter.step(2, 10);
  EXPECT_TRUE(transmitter.on());
  EXPECT_LT(transmitter.output_W(), 0.9 * warm(2, 10).output_W());
}

TEST(Transmitter, HeatIsWhatItDoesNotSend) {
  for (const double drive_mW : {0.5, 2.0, 8.0}) {
    const Transmitter transmitter = warm(drive_mW, 25);
    EXPECT_GT(transmitter.heat_W(), AmplifierConstants{}.quiescent_W);
    EXPECT_EQ(transmitter.heat_W() + transmitter.output_W(), transmitter.supply_W());
    EXPECT_LT(transmitter.output_W() / transmitter.supply_W(), 0.5);
  }
}

TEST(DrivePlan, DrivesOverStationsAndInSessionsAndNeverInSafeMode) {
  const reference::Orbit orbit{reference::OrbitConstants{}};
  const DrivePlan plan(orbit, {}, {}, 3);
  const DrivePlan safe(orbit, {}, {reference::usual(reference::LifeKind::safe_mode, start, start)},
                       3);
  const TransmitterConstants c;
  int on = 0, contact = 0;
  for (int s = 0; s < 86'400; ++s) {
    const storage::Time time = start + s * storage::second_ns;
    const double drive_mW = plan.drive_mW(time);
    EXPECT_EQ(safe.drive_mW(time), 0);
    if (orbit.in_contact(time)) {
      ++contact;
      EXPECT_GT(drive_mW, 0);
    }
    on += drive_mW > 0;
    EXPECT_LE(drive_mW, c.drive_max_mW * (1 + c.drive_step));
  }
  EXPECT_GT(contact, 1800);
  EXPECT_GT(on, contact + 3600);
  EXPECT_LT(on, 86'400 / 2);
}

}  // namespace
}  // namespace reident::satcs::platform::transmitter_test
