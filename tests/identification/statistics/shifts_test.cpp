#include "identification/statistics/shifts.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::shifts_test {
namespace {

/// The last column is what a model makes of the others.
std::optional<Shift> found(const Vector& values, const Matrix& columns) {
  return shift_of(values, columns.rightCols(1), columns, {{0, values.size()}});
}

/// Errors that last: each is so much of the one before.
Vector errors(test::Noise& noise, Index rows, double memory) {
  Vector values(rows);
  double before = 0;
  for (double& value : values) before = value = memory * before + noise.normal();
  return values / std::sqrt(values.squaredNorm() / double(rows));
}

void expect_shift(const std::optional<Shift>& shift, Shift::Of of, double row, double size,
                  double within) {
  ASSERT_TRUE(shift);
  EXPECT_EQ(shift->of, of);
  EXPECT_NEAR(double(shift->row), row, 5);
  EXPECT_NEAR(shift->size, size, within);
}

TEST(Shift, AStepIsFoundWhereItIs) {
  test::Noise noise(1);
  for (const double size : {3.0, -3.0}) {
    Vector values = errors(noise, 600, 0.5);
    values.tail(400).array() += size;
    expect_shift(found(values, noise.normal(600, 2)), Shift::Of::mean, 200, size, 0.4);
  }
}

TEST(Shift, AnotherGainIsFoundWhereItBegins) {
  test::Noise noise(5);
  for (const double size : {0.2, -0.2}) {
    const Matrix y_hat = 30 * noise.normal(600, 1);
    Vector values = errors(noise, 600, 0.5);
    values.tail(250) += size * y_hat.bottomRows(250);
    expect_shift(found(values, y_hat), Shift::Of::gain, 350, size, 0.02);
  }
}

TEST(Shift, ErrorsThatLastAreNone) {
  test::Noise noise(2);
  for (const auto& [memory, most] : {std::pair(0.0, 0), {0.8, 0}, {0.97, 15}}) {
    int steps = 0;
    for (int trial = 0; trial < 300; ++trial)
      steps += found(errors(noise, 600, memory), noise.normal(600, 1)).has_value();
    EXPECT_LE(steps, most) << memory;
  }
}

TEST(Shift, WhatADriftOrAWrongGainMakesIsNone) {
  test::Noise noise(3);
  Matrix input = noise.normal(600, 1);
  input.bottomRows(300).array() += 5;
  EXPECT_FALSE(found(0.6 * input.col(0) + errors(noise, 600, 0), input));
  const Vector drift = Vector::LinSpaced(600, -4, 4);
  EXPECT_FALSE(found(drift + errors(noise, 600, 0), noise.normal(600, 1)));
}

TEST(Shift, FewRowsOrOneValueHaveNone) {
  test::Noise noise(4);
  Vector values = errors(noise, 50, 0);
  values.tail(25).array() += 9;
  EXPECT_FALSE(found(values, noise.normal(50, 1)));
  EXPECT_FALSE(found(Vector::Ones(600), noise.normal(600, 1)));
  EXPECT_FALSE(found(Vector::Zero(600), Matrix::Zero(600, 1)));
}

}  // namespace
}  // namespace reident::identification::shifts_test
