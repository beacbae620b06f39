#include "service/satcs/pacer.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace reident::satcs::pacer_test {
namespace {

using namespace std::chrono_literals;

constexpr storage::Time second = 1'000'000'000;
constexpr Pacer::Clock::time_point noon{12h};

TEST(Pacer, SpacesFramesByTheirTimesAndTheSpeed) {
  Pacer pacer(10);
  EXPECT_EQ(pacer.due(100 * second, noon), noon);
  EXPECT_EQ(pacer.due(101 * second, noon + 1ms), noon + 100ms);
  EXPECT_EQ(pacer.due(200 * second, noon + 100ms), noon + 10s);
}

TEST(Pacer, DoesNotDriftWhenFramesComeALittleLate) {
  Pacer pacer(1);
  pacer.due(0, noon);
  EXPECT_EQ(pacer.due(1 * second, noon + 1500ms), noon + 1500ms);
  EXPECT_EQ(pacer.due(2 * second, noon + 1600ms), noon + 2s);
}

TEST(Pacer, GoesOnFromHereAfterALongWait) {
  Pacer pacer(1);
  pacer.due(0, noon);
  EXPECT_EQ(pacer.due(1 * second, noon + 1min), noon + 1min);
  EXPECT_EQ(pacer.due(2 * second, noon + 1min), noon + 1min + 1s);
}

TEST(Pacer, GoesOnFromATimeThatJumpsBack) {
  Pacer pacer(1);
  pacer.due(1000 * second, noon);
  EXPECT_EQ(pacer.due(10 * second, noon + 1s), noon + 1s);
  EXPECT_EQ(pacer.due(11 * second, noon + 1s), noon + 2s);
}

TEST(Pacer, NeverWaitsAtFullSpeed) {
  Pacer pacer(std::numeric_limits<double>::infinity());
  EXPECT_EQ(pacer.due(0, noon), noon);
  EXPECT_EQ(pacer.due(1'000'000 * second, noon + 1ns), noon + 1ns);
}

TEST(Pacer, WaitsForGapsThatNoClockHolds) {
  Pacer pacer(1e-9);
  pacer.due(0, noon);
  EXPECT_GT(pacer.due(std::numeric_limits<storage::Time>::max(), noon), noon + 24h * 300);
}

}  // namespace
}  // namespace reident::satcs::pacer_test
