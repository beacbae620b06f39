#include "identification/screening/relation_check.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reident::identification::relation_check_test {
namespace {

/// The residual of a balance that holds: noise, and the lag of a sensor at a load step every ten
/// minutes.
Vector honest(Index rows, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.1);
  Vector r(rows);
  for (Index t = 0; t < rows; ++t) r(t) = noise(random) + 5 * std::exp(-double(t % 600) / 5);
  return r;
}

std::vector<Inconsistency> found_in(const Vector& r, double tolerance = 0.5) {
  return inconsistencies(contiguous_record(1, Matrix(r.size(), 0), r), tolerance);
}

TEST(Consistency, OfHonestSensorsIsNotDoubted) {
  for (unsigned seed = 1; seed <= 20; ++seed) EXPECT_TRUE(found_in(honest(20'000, seed)).empty());
}

TEST(Consistency, IsBrokenByABiasOfALittleMoreThanTheTolerance) {
  for (const double bias : {0.55, -0.55, 3.0}) {
    Vector r = honest(20'000);
    r.segment(5'000, 3'000).array() += bias;
    const auto found = found_in(r);
    ASSERT_FALSE(found.empty()) << bias;
    EXPECT_NEAR(double(found.front().ticks.begin), 5'000, 200);
    EXPECT_NEAR(double(found.front().ticks.end), 8'000, 200);
    EXPECT_LE(found.front().ticks.begin, 5'000) << "all of it";
    EXPECT_NEAR(found.front().residual, bias, 0.05);
  }
}

TEST(Consistency, IsBrokenByAShiftBelowTheToleranceThatBeganWithinTheRows) {
  Vector r = honest(20'000);
  r.tail(6'000).array() += 0.35;
  const auto found = found_in(r);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].is_shift);
  EXPECT_NEAR(double(found[0].ticks.begin), 14'000, 300);
  EXPECT_EQ(found[0].ticks.end, 20'000);
}

TEST(Consistency, IsNotBrokenByACalibrationThatWasAlwaysOff) {
  EXPECT_TRUE(found_in(honest(20'000).array() + 0.35).empty());
}

TEST(Consistency, IsNotBrokenBySpikesOrShortLags) {
  Vector r = honest(20'000);
  for (Index t = 0; t < r.size(); t += 7) r(t) = 100;
  r.segment(9'000, 40).setConstant(-3);
  EXPECT_TRUE(found_in(r).empty());
}

TEST(Consistency, IsBrokenByNoiseThatNeverEnds) {
  Vector r = honest(20'000);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 2);
  for (double& value : r) value += noise(random);
  const auto found = found_in(r);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].ticks, (TickRange{0, 20'000}));
  EXPECT_NEAR(std::abs(found[0].residual), 1.35, 0.2);
}

TEST(Consistency, OfTooFewRowsIsNotJudged) {
  EXPECT_TRUE(found_in(Vector::Constant(120, 9)).empty());
  ASSERT_EQ(found_in(Vector::Constant(121, 9)).size(), 1U);
  EXPECT_EQ(found_in(Vector::Constant(121, 9))[0].ticks, (TickRange{0, 121}));
}

TEST(Consistency, TellsTicksAcrossGaps) {
  Vector r = honest(4'000);
  r.tail(2'000).array() += 2;
  Record record = contiguous_record(1, Matrix(r.size(), 0), r);
  record.segments = {{0, 2'000, 0}, {2'000, 4'000, 90'000}};
  const auto found = inconsistencies(record, 0.5);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(double(found.front().ticks.begin), 1'940, 40);
  EXPECT_EQ(found.back().ticks.end, 92'000);
}

}  // namespace
}  // namespace reident::identification::relation_check_test
