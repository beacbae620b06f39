#include "identification/simulation/scores.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::scores_test {
namespace {

TEST(Score, IsTheErrorOverTheSignalAndOverItsSpread) {
  Matrix y(4, 1), y_hat(4, 1);
  y << 1, 3, 1, 3;
  y_hat << 1, 3, 1, 1;
  const Score s = score(y, y_hat);
  EXPECT_NEAR(s.mrse_percent(0), 100 * 2 / std::sqrt(20), 1e-12);
  EXPECT_NEAR(s.fit_percent(0), 100 * (1 - 2 / std::sqrt(4)), 1e-12);
  EXPECT_EQ(s.rows, 4);
}

TEST(Score, OfSeveralOutputsTakesTheMeanErrorAndTheWorstFit) {
  Score s{Vector(2), Vector(2), 5};
  s.mrse_percent << 1, 3;
  s.fit_percent << 90, 70;
  EXPECT_DOUBLE_EQ(s.mrse(), 2);
  EXPECT_DOUBLE_EQ(s.fit(), 70);
}

TEST(Score, OfDeadOutputsHasTheLimits) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Matrix zero = Matrix::Zero(5, 1), constant = Matrix::Constant(5, 1, 0.1);
  EXPECT_EQ(score(zero, constant).mrse_percent(0), infinity);
  EXPECT_EQ(score(zero, constant).fit_percent(0), -infinity);
  EXPECT_EQ(score(constant, zero).fit_percent(0), -infinity);
  EXPECT_EQ(score(constant, constant).mrse_percent(0), 0);
  EXPECT_EQ(score(constant, constant).fit_percent(0), 100);
}

TEST(Score, OfANonFiniteRunIsTheWorst) {
  const Matrix y = Matrix::Random(5, 1);
  const Score s = score(y, Matrix::Constant(5, 1, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(s.mrse_percent(0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(s.fit_percent(0), -std::numeric_limits<double>::infinity());
}

TEST(Score, OfAFreeRunCountsTheScoredRowsAlone) {
  test::Noise noise(4);
  StateSpaceModel model = test::random_system(noise, 3, 2, 2);
  model.u0 << 4, -7;
  model.y0 << 28, 3;
  Record record = test::excited(model, noise, 200, 0);
  record.y.topRows(100).array() += 5;  // wrong where it is not scored, once the state has settled
  const Score s = score_free_run(model, record, {0, 200}, {180, 200}, Vector::Zero(3));
  EXPECT_EQ(s.rows, 20);
  EXPECT_LT(s.mrse(), 0.1);
}

}  // namespace
}  // namespace reident::identification::scores_test
