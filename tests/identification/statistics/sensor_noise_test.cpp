#include "identification/statistics/sensor_noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::sensor_noise_test {
namespace {

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

double noise_of(const Vector& y, const Vector& run, const std::vector<RowRange>& segments) {
  return std::sqrt(noise_squares(y, run, segments)(0));
}

TEST(NoiseSquares, AreWhatChangesFromRowToRow) {
  test::Noise noise(43);
  const Vector run = (5 + 4 * first_order(noise, rows, 0.99).array()).matrix();
  const Vector slow = first_order(noise, rows, 0.999), sensor = 0.1 * first_order(noise, rows, 0);
  const Vector y = run + slow + sensor;
  EXPECT_NEAR(noise_of(y, run, {{0, rows}}), 0.1, 0.01);
}

TEST(NoiseSquares, AreNotWhatStepsLeaveNorWhatGapsHide) {
  test::Noise noise(44);
  const Vector sensor = 0.1 * first_order(noise, rows, 0), run = Vector::Constant(rows, 5);
  Vector y = run + sensor;
  for (Index k = 0; k < rows; k += 40) y.segment(k, 2).array() += 3;
  EXPECT_NEAR(noise_of(y, run, {{0, rows}}), 0.1, 0.015);
  std::vector<RowRange> alone;
  for (Index k = 0; k < rows; ++k) alone.push_back({k, k + 1});
  EXPECT_NEAR(noise_of(y, run, alone), 0, 1e-9);
}

TEST(NoiseSquares, OfHeldSamplesAreThoseOfTheSamples) {
  test::Noise noise(45);
  constexpr Index held = 16;
  const Vector run = (5 + 4 * first_order(noise, rows * 4, 0.999).array()).matrix();
  const Vector sensor = 0.1 * first_order(noise, rows * 4, 0);
  Vector y = run + sensor;
  for (Index k = 0; k < y.size(); ++k) y(k) = y(k - k % held);
  EXPECT_NEAR(noise_of(y, run, {{0, y.size()}}), 0.1, 0.015);
}

TEST(NoiseSquares, LookAtNoDifferenceOverAGap) {
  test::Noise noise(46);
  const Vector sensor = 0.1 * first_order(noise, rows, 0), run = Vector::Constant(rows, 5);
  Vector y = run + sensor;
  std::vector<RowRange> segments;
  for (Index k = 0; k < rows; k += 2) {
    segments.push_back({k, k + 2});
    y.segment(k, 2).array() += 3 * noise.normal();
  }
  EXPECT_NEAR(noise_of(y, run, segments), 0.1, 0.015);
}

TEST(NoiseSquares, AreOfEachOutputAlone) {
  Matrix y(rows, 2);
  for (Index k = 0; k < rows; ++k) y.row(k) << (k % 2 ? 1 : 3), (k % 2 ? 10 : 11);
  const Vector squares = noise_squares(y, Matrix::Zero(rows, 2), {{0, rows}});
  EXPECT_GT(squares(0), 3 * squares(1));
  EXPECT_EQ(squares(0), noise_squares(y.col(0), Vector::Zero(rows), {{0, rows}})(0));
}

}  // namespace
}  // namespace reident::identification::sensor_noise_test
