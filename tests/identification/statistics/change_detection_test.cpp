#include "identification/statistics/change_detection.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::change_detection_test {
namespace {

constexpr double deviation = 0.3;  // of the logarithm of a block's error

Vector reference(test::Noise& noise, Index blocks) {
  return deviation * noise.normal(blocks, 1);
}

TEST(ChangeDetector, RaisesFewFalseAlarms) {
  struct {
    Index reference;
    int most;  // of 500,000 blocks
  } const cases[] = {{8, 250}, {16, 50}, {32, 25}};
  for (const auto& c : cases) {
    test::Noise noise(51);
    int alarms = 0;
    for (int i = 0; i < 500; ++i) {
      ChangeDetector detector(reference(noise, c.reference));
      for (int k = 0; k < 1000; ++k) alarms += detector.add(deviation * noise.normal());
    }
    EXPECT_LE(alarms, c.most) << c.reference;
  }
}

TEST(ChangeDetector, FindsErrorsThatDoubleWithinThirtyBlocks) {
  test::Noise noise(52);
  int within_ten = 0, within_thirty = 0;
  for (int i = 0; i < 1000; ++i) {
    ChangeDetector detector(reference(noise, 16));
    int blocks = 1;
    while (!detector.add(std::log(2) + deviation * noise.normal()) && blocks < 100) ++blocks;
    within_ten += blocks <= 10;
    within_thirty += blocks <= 30;
  }
  EXPECT_GT(within_ten, 600);
  EXPECT_GT(within_thirty, 980);
}

TEST(ChangeDetector, NoSingleBlockIsAChange) {
  test::Noise noise(53);
  ChangeDetector detector(reference(noise, 16));
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(detector.add(50));
    for (int k = 0; k < 10; ++k) EXPECT_FALSE(detector.add(detector.mean()));
  }
  EXPECT_FALSE(detector.add(std::numeric_limits<double>::infinity()));
}

TEST(ChangeDetector, BeginsAnewAfterAChange) {
  test::Noise noise(54);
  ChangeDetector detector(reference(noise, 16));
  int blocks = 1;
  while (!detector.add(5)) ++blocks;
  EXPECT_GE(blocks, 3);
  EXPECT_EQ(detector.statistic(), 0);
}

TEST(ChangeDetector, OfErrorsThatNeverDifferStillNeedsSeveralBlocks) {
  ChangeDetector detector(Vector::Constant(8, -2.0));
  EXPECT_FALSE(detector.add(-1));
  EXPECT_FALSE(detector.add(-1));
}

}  // namespace
}  // namespace reident::identification::change_detection_test
