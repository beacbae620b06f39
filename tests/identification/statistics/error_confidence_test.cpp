#include "identification/statistics/error_confidence.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::error_confidence_test {
namespace {

/// Outputs 3 + x and errors, both first-order noises; the error of infinitely many rows is known.
struct Trial {
  Matrix y, y_hat;
  double true_percent;
};

Trial trial(test::Noise& noise, Index rows, double phi) {
  const double variance = 1 / (1 - phi * phi), x_variance = 1 / (1 - 0.64);
  Trial result{Matrix(rows, 1), Matrix(rows, 1),
               100 * std::sqrt(variance / (9 + x_variance + variance))};
  double e = std::sqrt(variance) * noise.normal(), x = std::sqrt(x_variance) * noise.normal();
  for (Index k = 0; k < rows; ++k) {
    result.y_hat(k, 0) = 3 + x;
    result.y(k, 0) = 3 + x + e;
    e = phi * e + noise.normal();
    x = 0.8 * x + noise.normal();
  }
  return result;
}

double coverage(Index rows, double phi) {
  test::Noise noise(17);
  int covered = 0;
  for (int i = 0; i < 200; ++i) {
    const Trial t = trial(noise, rows, phi);
    const auto interval = error_interval(t.y, t.y_hat, {{0, rows}});
    covered += interval->low(0) <= t.true_percent && t.true_percent <= interval->high(0);
  }
  return covered / 200.0;
}

TEST(ErrorInterval, CoversTheTrueErrorInAboutNineteenOfTwentyTrials) {
  EXPECT_NEAR(coverage(2000, 0), 0.95, 0.04);
  EXPECT_NEAR(coverage(2000, 0.7), 0.95, 0.04);
  EXPECT_NEAR(coverage(2000, 0.9), 0.95, 0.04);
  EXPECT_NEAR(coverage(500, 0.7), 0.95, 0.06);
}

TEST(ErrorInterval, HoldsTheErrorAndIsTheSameEveryTime) {
  test::Noise noise(1);
  const Trial t = trial(noise, 1000, 0.5);
  const double error = score(t.y, t.y_hat).mrse();
  const auto first = error_interval(t.y, t.y_hat, {{0, 1000}});
  const auto second = error_interval(t.y, t.y_hat, {{0, 1000}});
  EXPECT_LT(first->low(0), error);
  EXPECT_GT(first->high(0), error);
  EXPECT_EQ(first->low(0), second->low(0));
  EXPECT_EQ(first->high(0), second->high(0));
  EXPECT_EQ(first->mean_low, first->low(0));
  EXPECT_EQ(first->mean_high, first->high(0));
}

TEST(ErrorInterval, NarrowsWithTheRootOfTheRows) {
  test::Noise noise(2);
  const auto width = [&noise](Index rows) {
    const Trial t = trial(noise, rows, 0.5);
    const auto interval = error_interval(t.y, t.y_hat, {{0, rows}});
    return interval->high(0) - interval->low(0);
  };
  EXPECT_NEAR(width(1000) / width(16000), 4, 1.5);
}

TEST(ErrorInterval, TakesLongerBlocksForLongerCorrelation) {
  test::Noise noise(3);
  const auto block = [&noise](double phi) {
    const Trial t = trial(noise, 5000, phi);
    return error_interval(t.y, t.y_hat, {{0, 5000}})->block_rows;
  };
  EXPECT_LT(block(0.5), block(0.98));
  EXPECT_GE(block(0), 20);       // a 250th of the rows
  EXPECT_LE(block(0.999), 500);  // a tenth
}

TEST(ErrorInterval, SaysWhenTheRowsAreTooFewForTheCorrelation) {
  test::Noise noise(4);
  const Trial slow = trial(noise, 200, 0.99), quick = trial(noise, 2000, 0.5);
  EXPECT_TRUE(error_interval(slow.y, slow.y_hat, {{0, 200}})->too_few_rows);
  EXPECT_FALSE(error_interval(quick.y, quick.y_hat, {{0, 2000}})->too_few_rows);
}

TEST(ErrorInterval, OfTwoOutputsHoldsTheMean) {
  test::Noise noise(5);
  const Trial a = trial(noise, 1000, 0.5), b = trial(noise, 1000, 0.9);
  Matrix y(1000, 2), y_hat(1000, 2);
  y << a.y, b.y;
  y_hat << a.y_hat, b.y_hat;
  const auto interval = error_interval(y, y_hat, {{0, 400}, {400, 1000}});
  const double error = score(y, y_hat).mrse();
  EXPECT_LT(interval->mean_low, error);
  EXPECT_GT(interval->mean_high, error);
  EXPECT_LT(interval->mean_high, interval->high.maxCoeff());
}

TEST(ErrorInterval, IsAbsentWhereItMeansNothing) {
  test::Noise noise(6);
  const Trial t = trial(noise, 100, 0.5);
  EXPECT_FALSE(error_interval(t.y.topRows(49), t.y_hat.topRows(49), {{0, 49}}));
  EXPECT_FALSE(error_interval(t.y, t.y, {{0, 100}}));
  EXPECT_FALSE(error_interval(Matrix::Zero(100, 1), t.y_hat, {{0, 100}}));
  Matrix broken = t.y_hat;
  broken(3, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(error_interval(t.y, broken, {{0, 100}}));
}

TEST(ErrorSpread, IsTheErrorOfTenthsOfTheRows) {
  Matrix y = Matrix::Ones(100, 1), y_hat = y;
  y_hat.middleRows(10, 10).array() += 0.5;
  for (Index part = 2; part < 7; ++part) y_hat.middleRows(10 * part, 10).array() += 0.1;
  const ErrorSpread spread = error_spread(y, y_hat);
  EXPECT_EQ(spread.parts, 10);
  EXPECT_NEAR(spread.smallest(0), 0, 1e-12);
  EXPECT_NEAR(spread.median(0), 10, 1e-9);
  EXPECT_NEAR(spread.largest(0), 50, 1e-9);
}

TEST(ErrorSpread, OfAPartInWhichTheOutputRestsAtZeroIsFinite) {
  test::Noise noise(7);
  Matrix y = noise.normal(1003, 2), y_hat = y + 0.1 * noise.normal(1003, 2);
  y.topRows(200).setZero();
  const ErrorSpread spread = error_spread(y, y_hat);
  EXPECT_TRUE(spread.largest.allFinite());
  const Score whole = score(y, y_hat);
  for (Index q = 0; q < 2; ++q) {
    EXPECT_LT(spread.smallest(q), whole.mrse_percent(q));
    EXPECT_GT(spread.largest(q), whole.mrse_percent(q));
  }
}

TEST(ErrorSpread, OfFewRowsHasFewerParts) {
  const Matrix y = Matrix::Ones(35, 1);
  EXPECT_EQ(error_spread(y, 2 * y).parts, 3);
  EXPECT_EQ(error_spread(y.topRows(1), 2 * y.topRows(1)).parts, 1);
  EXPECT_NEAR(error_spread(y.topRows(1), 2 * y.topRows(1)).median(0), 100, 1e-12);
}

}  // namespace
}  // namespace reident::identification::error_confidence_test
