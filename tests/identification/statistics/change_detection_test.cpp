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

TEST(ChangeDetector, SaysWithHowManyBlocksAChangeMayHaveBegun) {
  // Errors rise a little before they jump, double, or one block stands out of errors that doubled.
  const struct {
    const char* name;
    double before, behind, last;
    double most;  // blocks that are too many, in the mean
  } cases[] = {{"jump", 0.3, 5, 5, 1},
               {"doubled", 0, std::log(2), std::log(2), 8},
               {"outlier", 0, std::log(2), 20, 8}};
  for (const auto& c : cases) {
    test::Noise noise(55);
    int missed = 0, found = 0;
    double early = 0;
    for (int i = 0; i < 500; ++i) {
      ChangeDetector detector(reference(noise, 32));
      for (int k = 0; k < 8; ++k)
        if (detector.add(c.before + deviation * noise.normal())) detector.add(-50);
      int blocks = 1;
      while (!detector.add((blocks == 6 ? c.last : c.behind) + deviation * noise.normal()))
        ++blocks;
      ++found;
      missed += detector.blocks_since() < blocks;
      early += std::max<double>(0, double(detector.blocks_since() - blocks));
    }
    EXPECT_LE(missed, found / 5) << c.name;
    EXPECT_LE(early / found, c.most) << c.name;
  }
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
