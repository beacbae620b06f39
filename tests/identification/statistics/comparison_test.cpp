#include "identification/statistics/comparison.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::comparison_test {
namespace {

constexpr double confidence = 0.99;
constexpr Index rows = 2000;

Vector first_order(test::Noise& noise, Index count, double coefficient) {
  Vector values(count);
  double value = noise.normal() / std::sqrt(1 - coefficient * coefficient);
  for (Index k = 0; k < count; ++k) {
    values(k) = value;
    value = coefficient * value + noise.normal();
  }
  return values * std::sqrt(1 - coefficient * coefficient);
}

/// A measured output and the run of a model whose errors have the deviation 1.
struct Trial {
  Matrix y, run;
};

Trial trial(test::Noise& noise, double coefficient) {
  Trial result;
  result.run = (5 + 4 * first_order(noise, rows, 0.9).array()).matrix();
  result.y = result.run + first_order(noise, rows, coefficient);
  return result;
}

/// Share of 1,000 trials in which the other run is better with 99 % confidence.
double promoted(double coefficient,
                const std::function<Matrix(const Trial&, test::Noise&)>& other) {
  test::Noise noise(41);
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial t = trial(noise, coefficient);
    const auto compared = compare_runs(t.y, t.run, other(t, noise), {{0, rows}}, confidence,
                                       Stationarity::stationary);
    count += compared && compared->low > 0;
  }
  return count / 1000.0;
}

class OfErrors : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Coloured, OfErrors, ::testing::Values(0.0, 0.8, 0.98));

TEST_P(OfErrors, ARunIsNeverSurelyBetterThanItself) {
  EXPECT_EQ(promoted(GetParam(), [](const Trial& t, auto&) { return t.run; }), 0);
}

TEST_P(OfErrors, NoiseOnARunIsPromotedInFewerThanOneOfAHundredTrials) {
  for (const double size : {0.01, 0.1, 0.5})
    EXPECT_LT(promoted(GetParam(),
                       [size](const Trial& t, test::Noise& noise) -> Matrix {
                         return t.run + size * noise.normal(rows, 1);
                       }),
              0.01)
        << size;
  EXPECT_LT(promoted(GetParam(),
                     [](const Trial& t, test::Noise& noise) -> Matrix {
                       return t.run + 0.3 * first_order(noise, rows, 0.98);
                     }),
            0.01);
}

TEST(PairedComparison, ARunThatErrsByATenthLessIsFoundInMoreThanNineteenOfTwentyTrials) {
  const auto better = [](const Trial& t, auto&) -> Matrix { return 0.1 * t.y + 0.9 * t.run; };
  EXPECT_GT(promoted(0, better), 0.95);
  EXPECT_GT(promoted(0.8, better), 0.95);
}

TEST(PairedComparison, OfModelsThatErrByDifferentThingsFindsAnErrorSmallerByATenth) {
  // Half of the error is common to both; the rest is each one's own, coloured.
  test::Noise noise(43);
  int found = 0, wrong = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial t = trial(noise, 0.5);
    const Matrix one = t.run + 0.7 * first_order(noise, rows, 0.5);
    const Matrix other = t.run + 0.3 * first_order(noise, rows, 0.5);
    const auto compared =
        compare_runs(t.y, one, other, {{0, rows}}, confidence, Stationarity::stationary);
    const auto reversed =
        compare_runs(t.y, other, one, {{0, rows}}, confidence, Stationarity::stationary);
    found += compared->low > 0;
    wrong += reversed->low > 0;
  }
  EXPECT_GT(found, 950);
  EXPECT_EQ(wrong, 0);
}

TEST(PairedComparison, OfAnEquipmentThatChangesAllTheTimeFindsTheRunThatFollows) {
  // The incumbent's gain is off by more and more; each run has an error of its own.
  test::Noise noise(47);
  const Vector growing = Vector::LinSpaced(rows, 0, 0.3);
  int found = 0, found_as_steady = 0, wrong = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial t = trial(noise, 0.8);
    const Matrix follows = t.run + 0.3 * first_order(noise, rows, 0.98);
    const Matrix stays = t.run - growing.cwiseProduct(t.run) + 0.3 * first_order(noise, rows, 0.98);
    const auto low = [&](const Matrix& incumbent, const Matrix& candidate,
                         Stationarity stationarity) {
      return compare_runs(t.y, incumbent, candidate, {{0, rows}}, confidence, stationarity)->low;
    };
    found += low(stays, follows, Stationarity::changing) > 0.15;
    found_as_steady += low(stays, follows, Stationarity::stationary) > 0.15;
    wrong += low(follows, stays, Stationarity::changing) > 0;
  }
  EXPECT_GT(found, 600);
  EXPECT_LT(found_as_steady, 50);
  EXPECT_EQ(wrong, 0);
}

TEST(PairedComparison, OfRunsThatErrAlikeAndSlowlySeldomFindsOneBetter) {
  test::Noise noise(48);
  int steady = 0, changing = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial t = trial(noise, 0.5);
    const Matrix one = t.run + first_order(noise, rows, 0.98);
    const Matrix other = t.run + first_order(noise, rows, 0.98);
    steady +=
        compare_runs(t.y, one, other, {{0, rows}}, confidence, Stationarity::stationary)->low > 0;
    changing +=
        compare_runs(t.y, one, other, {{0, rows}}, confidence, Stationarity::changing)->low > 0;
  }
  EXPECT_LT(steady, 20);
  EXPECT_LT(changing, 20);
}

TEST(PairedComparison, AStuckSensorDoesNotPromoteWhoeverAgreesWithIt) {
  test::Noise noise(44);
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    Trial t = trial(noise, 0.5);
    const Index begin = static_cast<Index>(noise.uniform() * 0.9 * rows), stuck = rows * 3 / 100;
    Matrix agreeing = t.run + 0.2 * first_order(noise, rows, 0.9);
    t.y.middleRows(begin, stuck).setConstant(40);
    agreeing.middleRows(begin, stuck).setConstant(35);
    const auto compared =
        compare_runs(t.y, t.run, agreeing, {{0, rows}}, confidence, Stationarity::stationary);
    EXPECT_GT(compared->reduction, 0.5);
    count += compared->low > 0;
  }
  EXPECT_LT(count, 10);
}

TEST(PairedComparison, TellsTheReductionOfTheErrorAndBoundsItFromBelow) {
  test::Noise noise(45);
  const Trial t = trial(noise, 0.5);
  const Matrix better = 0.4 * t.y + 0.6 * t.run;
  const auto compared =
      compare_runs(t.y, t.run, better, {{0, rows}}, confidence, Stationarity::stationary);
  ASSERT_TRUE(compared);
  EXPECT_NEAR(compared->reduction, 1 - score(t.y, better).mrse() / score(t.y, t.run).mrse(), 1e-9);
  EXPECT_NEAR(compared->reduction, 0.4, 1e-9);
  EXPECT_LE(compared->low, compared->reduction);
  EXPECT_GE(compared->blocks, 10);
}

TEST(PairedComparison, WeighsOutputsAsTheErrorDoes) {
  test::Noise noise(46);
  const Matrix run = Matrix::Constant(500, 2, 3) + noise.normal(500, 2);
  Matrix y = run + noise.normal(500, 2) * Eigen::Vector2d(1, 0.01).asDiagonal();
  Matrix other = run;
  other.col(0) = 0.5 * (y.col(0) + run.col(0));
  const auto compared =
      compare_runs(y, run, other, {{0, 500}}, confidence, Stationarity::stationary);
  EXPECT_NEAR(compared->reduction, 1 - score(y, other).mrse() / score(y, run).mrse(), 1e-6);
  EXPECT_GT(compared->low, 0.3);
}

TEST(PairedComparison, OfARunWithoutErrorIsCertain) {
  test::Noise noise(47);
  const Trial t = trial(noise, 0);
  const auto compared =
      compare_runs(t.y, t.run, t.y, {{0, rows}}, confidence, Stationarity::stationary);
  ASSERT_TRUE(compared);
  EXPECT_GT(compared->low, 0.999);
}

TEST(PairedComparison, SaysNothingOfTooFewRowsZerosOrInfinities) {
  test::Noise noise(48);
  const Trial t = trial(noise, 0);
  EXPECT_FALSE(compare_runs(t.y.topRows(49), t.run.topRows(49), t.run.topRows(49), {{0, 49}},
                            confidence, Stationarity::stationary));
  const Matrix zero = Matrix::Zero(100, 1), one = Matrix::Ones(100, 1);
  EXPECT_FALSE(compare_runs(zero, one, zero, {{0, 100}}, confidence, Stationarity::stationary));
  Matrix astray = t.run;
  astray(7, 0) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(compare_runs(t.y, astray, t.run, {{0, rows}}, confidence, Stationarity::stationary));
}

TEST(NoisePercent, IsWhatChangesFromRowToRow) {
  test::Noise noise(43);
  const Vector run = (5 + 4 * first_order(noise, rows, 0.99).array()).matrix();
  const Vector slow = first_order(noise, rows, 0.999), sensor = 0.1 * first_order(noise, rows, 0);
  const double size = run.norm() / std::sqrt(double(rows));
  const Vector y = run + slow + sensor;
  EXPECT_NEAR(noise_percent(y, run, {{0, rows}}), 100 * 0.1 / size, 0.1 * 100 * 0.1 / size);
}

TEST(NoisePercent, IsNotWhatStepsLeaveNorWhatGapsHide) {
  test::Noise noise(44);
  const Vector sensor = 0.1 * first_order(noise, rows, 0), run = Vector::Constant(rows, 5);
  Vector y = run + sensor;
  for (Index k = 0; k < rows; k += 40) y.segment(k, 2).array() += 3;
  const double expected = 100 * 0.1 / (y.norm() / std::sqrt(double(rows)));
  EXPECT_NEAR(noise_percent(y, run, {{0, rows}}), expected, 0.15 * expected);
  std::vector<RowRange> alone;
  for (Index k = 0; k < rows; ++k) alone.push_back({k, k + 1});
  EXPECT_NEAR(noise_percent(y, run, alone), 0, 1e-9);
}

TEST(NoisePercent, OfHeldSamplesIsThatOfTheSamples) {
  test::Noise noise(45);
  constexpr Index held = 16;
  const Vector run = (5 + 4 * first_order(noise, rows * 4, 0.999).array()).matrix();
  const Vector sensor = 0.1 * first_order(noise, rows * 4, 0);
  Vector y = run + sensor;
  for (Index k = 0; k < y.size(); ++k) y(k) = y(k - k % held);
  const double expected = 100 * 0.1 / (y.norm() / std::sqrt(double(y.size())));
  EXPECT_NEAR(noise_percent(y, run, {{0, y.size()}}), expected, 0.15 * expected);
}

TEST(NoisePercent, LooksAtNoDifferenceOverAGap) {
  test::Noise noise(46);
  const Vector sensor = 0.1 * first_order(noise, rows, 0), run = Vector::Constant(rows, 5);
  Vector y = run + sensor;
  std::vector<RowRange> segments;
  for (Index k = 0; k < rows; k += 2) {
    segments.push_back({k, k + 2});
    y.segment(k, 2).array() += 3 * noise.normal();
  }
  const double expected = 100 * 0.1 / (y.norm() / std::sqrt(double(rows)));
  EXPECT_NEAR(noise_percent(y, run, segments), expected, 0.15 * expected);
}

TEST(NoisePercent, IsTheMeanOfTheOutputs) {
  Matrix y(rows, 2);
  for (Index k = 0; k < rows; ++k) y.row(k) << (k % 2 ? 1 : 3), (k % 2 ? 10 : 11);
  const Matrix run = Matrix::Zero(rows, 2);
  const auto of = [&](Index q) { return noise_percent(y.col(q), run.col(q), {{0, rows}}); };
  EXPECT_GT(of(0), 5 * of(1));
  EXPECT_NEAR(noise_percent(y, run, {{0, rows}}), (of(0) + of(1)) / 2, 1e-9);
}

}  // namespace
}  // namespace reident::identification::comparison_test
