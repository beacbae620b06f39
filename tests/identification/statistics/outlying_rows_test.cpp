#include "identification/statistics/outlying_rows.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::outlying_rows_test {
namespace {

constexpr Index rows = 600;

/// Errors that last, of deviation 1.
Vector errors(test::Noise& noise, double past) {
  Vector values = noise.normal(rows, 1);
  for (Index t = 1; t < rows; ++t) values(t) = past * values(t - 1) + values(t);
  return values * std::sqrt(1 - past * past);
}

TEST(OutlyingRows, AreThoseThatWerePutThere) {
  for (const double past : {0.0, 0.9}) {
    test::Noise noise(3);
    Vector values = errors(noise, past);
    std::vector<Index> there;
    for (Index t = 20; t + 2 < rows; t += 33) {
      values(t) += 20 + 60 * noise.uniform();
      there.push_back(t);
    }
    EXPECT_EQ(outlying_rows(values, {{0, rows}}), there) << past;
  }
}

TEST(OutlyingRows, TwoBesideEachOtherAreFound) {
  test::Noise noise(4);
  Vector values = errors(noise, 0.5);
  for (const Index t : {100, 101, 350, 351}) values(t) += 50;
  EXPECT_THAT(outlying_rows(values, {{0, rows}}), testing::ElementsAre(100, 101, 350, 351));
}

TEST(OutlyingRows, ErrorsHaveNone) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    test::Noise noise(seed);
    const Vector values = errors(noise, 0.01 * double(seed - 1));
    EXPECT_TRUE(outlying_rows(values, {{0, rows}}).empty()) << seed;
    // With more large values than normal ones have.
    const Vector heavy =
        values.cwiseProduct(noise.normal(rows, 1).cwiseAbs() + Vector::Constant(rows, 0.2));
    EXPECT_TRUE(outlying_rows(heavy, {{0, rows}}).empty()) << seed;
  }
}

TEST(OutlyingRows, AThirdOfTheRowsIsHowTheErrorsAre) {
  test::Noise noise(5);
  Vector values = errors(noise, 0);
  for (Index t = 0; t < rows; t += 3) values(t) += 50;
  EXPECT_TRUE(outlying_rows(values, {{0, rows}}).empty());
}

TEST(OutlyingRows, WhereNearlyAllAreTheMedianAnyOtherIsOff) {
  Vector values = Vector::Zero(rows);
  for (Index t = 0; t < rows; ++t) values(t) = t % 80 < 40 ? 0 : 1;
  for (const Index t : {100, 350}) values(t) += 5;
  EXPECT_THAT(outlying_rows(values, {{0, rows}}), testing::ElementsAre(100, 350));
}

TEST(OutlyingRows, AShareOfTheSquaresIsAskedOrNot) {
  test::Noise noise(6);
  Vector values = errors(noise, 0);
  values(100) += 15;
  EXPECT_TRUE(outlying_rows(values, {{0, rows}}).empty());
  EXPECT_THAT(outlying_rows(values, {{0, rows}}, 0), testing::ElementsAre(100));
}

TEST(OutlyingRows, StepsAndFewRowsHaveNone) {
  Vector values = Vector::Zero(rows);
  values.tail(rows / 2).setConstant(100);
  EXPECT_TRUE(outlying_rows(values, {{0, rows}}).empty());
  EXPECT_TRUE(outlying_rows(values.head(4), {{0, 4}}).empty());
  EXPECT_TRUE(outlying_rows(Vector(), {}).empty());
}

}  // namespace
}  // namespace reident::identification::outlying_rows_test
