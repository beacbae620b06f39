#include "identification/statistics/limits.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::limits_test {
namespace {

constexpr Index rows = 600;

/// What drives an output, and the errors of its model.
struct Output {
  explicit Output(std::uint64_t seed) {
    test::Noise noise(seed);
    y_hat = noise.normal(rows, 1);
    for (Index t = 1; t < rows; ++t) y_hat(t) = 0.8 * y_hat(t - 1) + 0.6 * y_hat(t);
    y = y_hat + 0.05 * noise.normal(rows, 1);
  }
  Vector y_hat, y;
};

std::vector<Index> rows_at(const Vector& values, double value) {
  std::vector<Index> found;
  for (Index row = 0; row < values.size(); ++row)
    if (values(row) == value) found.push_back(row);
  return found;
}

TEST(Limits, AreEndsThatAModelGoesBeyond) {
  const Output output(1);
  const Vector high = output.y.cwiseMin(1.0), low = output.y.cwiseMax(-1.0);
  for (const bool is_greatest : {true, false}) {
    const auto found = limits_of(is_greatest ? high : low, output.y_hat);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].is_greatest, is_greatest);
    EXPECT_EQ(found[0].rows, rows_at(is_greatest ? high : low, is_greatest ? 1 : -1));
  }
  EXPECT_EQ(limits_of(high.cwiseMax(-1.0), output.y_hat).size(), 2u);
}

TEST(Limits, NoOutputHasThemThatFollowsItsModel) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Output output(seed);
    EXPECT_TRUE(limits_of(output.y, output.y_hat).empty()) << seed;
    // At rest at one end, as a current in eclipse, or in steps of a digit.
    const Vector resting = output.y.cwiseMax(0.0), digits = (output.y * 4).array().round();
    EXPECT_TRUE(limits_of(resting, output.y_hat.cwiseMax(0.0)).empty()) << seed;
    EXPECT_TRUE(limits_of(digits, output.y_hat * 4).empty()) << seed;
  }
}

// A converter's current in eclipse: the model runs on below zero for a few rows.
TEST(Limits, WhereInputsRestThereIsNone) {
  Output output(4);
  for (Index t = 0; t < rows; ++t)
    if (t % 100 < 30) {
      output.y(t) = -3;
      output.y_hat(t) = t % 100 < 2 ? -4 : -3;
    }
  EXPECT_TRUE(limits_of(output.y.cwiseMax(-3.0), output.y_hat).empty());
}

TEST(Limits, AModelThatErrsMoreThanItGoesBeyondShowsNone) {
  const Output output(2);
  test::Noise noise(3);
  EXPECT_TRUE(limits_of(output.y.cwiseMin(2.5), output.y_hat + noise.normal(rows, 1)).empty());
  EXPECT_TRUE(limits_of(Vector::Zero(rows), output.y_hat).empty());
  EXPECT_TRUE(limits_of(Vector(0), Vector(0)).empty());
}

}  // namespace
}  // namespace reident::identification::limits_test
