#include "service/client/live_equipment.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/service/client/live_telemetry.hpp"

namespace reident::test::live_equipment_test {
namespace {

class LiveBdr : public testing::Test {
 protected:
  LiveBdr() { describe_all(live_); }
  void fly(std::int64_t from, std::int64_t to) {
    for (std::int64_t k = from; k < to; ++k) live_.add(plant_.frame(k));
  }

  ExamplePlant plant_;
  LiveEquipment live_{example_version(1)};
};

TEST_F(LiveBdr, MeetsAPlantThatIsTheModel) {
  fly(0, 500);
  EXPECT_EQ(live_.score().rows, 499 - 6) << "all ticks but those of the seed and the last";
  EXPECT_LT(live_.score().mrse(), 1e-6);
  EXPECT_GT(live_.score().fit(), 99.999);
  EXPECT_EQ(live_.gaps(), 0U);
  EXPECT_EQ(live_.ticks_outside(), 0U);
}

TEST_F(LiveBdr, FindsItsStateAgainAfterAGap) {
  fly(0, 100);
  for (std::int64_t k = 100; k < 200; ++k) plant_.frame(k);
  fly(200, 300);
  EXPECT_EQ(live_.gaps(), 1U);
  EXPECT_LT(live_.score().mrse(), 0.2) << "the last outputs before the gap are held for two ticks";
}

TEST_F(LiveBdr, StartsAtTheOperatingPointWhereNoOutputIsMeasured) {
  for (std::int64_t k = 0; k < 200; ++k) {
    auto frame = plant_.frame(k);
    if (k < 150) frame.samples.pop_back();
    live_.add(frame);
  }
  EXPECT_EQ(live_.score().rows, 49);
  EXPECT_LT(live_.score().mrse(), 1e-3) << "the start is forgotten by then";
}

TEST_F(LiveBdr, GoesOnWithANewVersionAndCountsItsErrorAnew) {
  fly(0, 300);
  ModelVersion next = example_version(2);
  next.model.dynamics.B *= 1.1;
  const auto swap = live_.adopt(next);
  ASSERT_TRUE(swap);
  EXPECT_EQ(swap->rows, PreparedModel::matched_rows);
  EXPECT_EQ(live_.version().number, 2);
  EXPECT_EQ(live_.score().rows, 0);
  fly(300, 400);
  EXPECT_EQ(live_.score().rows, 100) << "no tick was missed";
  EXPECT_GT(live_.score().mrse(), 0.5);
  EXPECT_EQ(live_.gaps(), 0U);
}

TEST_F(LiveBdr, StartsOverWithAVersionOfOtherInputs) {
  fly(0, 50);
  ModelVersion next = example_version(2);
  std::swap(next.model.inputs[0], next.model.inputs[1]);
  next.model.dynamics.B.col(0).swap(next.model.dynamics.B.col(1));
  next.model.dynamics.D.col(0).swap(next.model.dynamics.D.col(1));
  std::swap(next.model.dynamics.u0(0), next.model.dynamics.u0(1));
  next.model.inputs[0].expression = "I_BDRIN2 + 0";
  EXPECT_FALSE(live_.adopt(next));
  describe_all(live_);
  fly(50, 150);
  EXPECT_GT(live_.score().rows, 80);
  EXPECT_LT(live_.score().mrse(), 1e-6);
}

TEST_F(LiveBdr, CountsTicksOutsideTheIdentifiedRange) {
  fly(0, 50);
  ModelVersion next = example_version(2);
  next.model.inputs[0].high = 1;
  live_.adopt(next);
  fly(50, 250);
  EXPECT_GT(live_.ticks_outside(), 50U);
  EXPECT_LT(live_.ticks_outside(), 200U);
}

}  // namespace
}  // namespace reident::test::live_equipment_test
