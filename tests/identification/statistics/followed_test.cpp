#include "identification/statistics/followed.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::followed_test {
namespace {

constexpr Index rows = 900;

/// What one state makes of an input.
Vector response(const Vector& u, double gain) {
  Vector y = Vector::Zero(u.size());
  for (Index t = 1; t < u.size(); ++t) y(t) = 0.9 * y(t - 1) + 0.1 * gain * u(t - 1);
  return y;
}

TEST(Followed, AShareIsWithinItsErrorsOfTheTrueOne) {
  struct Case {
    Index every;
    double share;
  };
  for (const Case& one : {Case{29, 0}, Case{29, 1}, Case{29, 0.5}, Case{450, 0}, Case{450, 1}})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      test::Noise noise(seed);
      const Vector u = noise.normal(rows, 1);
      Vector pulses = Vector::Zero(rows);
      std::vector<Index> there;
      for (Index t = 20; t < rows; t += one.every) {
        pulses(t) = 8 + 4 * noise.uniform();
        there.push_back(t);
      }
      const Vector y = response(u + one.share * pulses, 1) + 0.02 * noise.normal(rows, 1);
      // The gain is wrong by a tenth, and an offset makes up for the mean of the pulses.
      const Vector of_pulses = response(pulses, 0.9), of_rest = response(u, 0.9);
      const Vector errors = y - of_pulses - of_rest + Vector::Constant(rows, 0.1);
      const auto [these, rest] = followed(errors, {of_pulses, of_rest}, there, {{0, rows}});
      EXPECT_NEAR(these.share, one.share / 0.9, 4 * these.deviation) << one.share << ' ' << seed;
      EXPECT_NEAR(rest.share, 1 / 0.9, 4 * rest.deviation) << one.share << ' ' << seed;
      EXPECT_LT(std::max(these.deviation, rest.deviation), 0.25) << one.share << ' ' << seed;
    }
}

TEST(Followed, WhatHasNoEffectOfItsOwnIsFollowed) {
  test::Noise noise(1);
  const Matrix errors = noise.normal(rows, 2), effect = noise.normal(rows, 2);
  for (const Matrix& other : {Matrix(Matrix::Zero(rows, 2)), Matrix(2 * effect)})
    for (const Followed& one : followed(errors, {effect, other}, {5}, {{0, rows}}))
      EXPECT_EQ(one.share, 1);
}

TEST(Bridged, ALineStandsInPlaceOfRows) {
  const Vector values = Vector::LinSpaced(9, 0, 8);
  Vector spoilt = values;
  for (const Index row : {0, 3, 4, 6}) spoilt(row) = 50;
  Vector expected = values;
  expected(0) = 1;  // the next row
  expected(6) = 5;  // the last row of the first segment
  const Vector found = bridged(spoilt, {0, 3, 4, 6}, {{0, 7}, {7, 9}});
  EXPECT_EQ(found, expected);
  EXPECT_EQ(bridged(spoilt, {0, 3}, {{0, 1}, {3, 4}}), spoilt);
}

}  // namespace
}  // namespace reident::identification::followed_test
