#include "identification/fit/static_regression.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"

namespace reident::identification::static_regression_test {
namespace {

Record record_of(const Matrix& u, const Matrix& y) {
  Record record;
  record.period_s = 2;
  record.u = u;
  record.y = y;
  record.segments = {{0, u.rows(), 0}};
  return record;
}

/// Two inputs that move in their own ways.
Matrix inputs(Index rows) {
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k) u.row(k) << std::sin(0.3 * double(k)), 100 + double(k % 7);
  return u;
}

TEST(StaticRegression, FindsTheGainAndTheOffset) {
  const Matrix u = inputs(200);
  Matrix y(200, 2);
  y.col(0) = (2 * u.col(0) - 0.5 * u.col(1)).array() + 3;
  y.col(1) = -u.col(1);
  const Record record = record_of(u, y);
  const StateSpaceModel model = static_regression(record, record.all());
  EXPECT_EQ(model.order(), 0);
  EXPECT_TRUE(is_well_formed(model));
  EXPECT_EQ(spectral_radius(model), 0);
  EXPECT_NEAR(model.D(0, 0), 2, 1e-12);
  EXPECT_NEAR(model.D(0, 1), -0.5, 1e-12);
  EXPECT_NEAR(model.D(1, 0), 0, 1e-12);
  EXPECT_LT((free_run(model, record, record.all()) - y).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(StaticRegression, LooksAtTheRowsThatItIsGivenAlone) {
  const Matrix u = inputs(200);
  Matrix y = 2 * u.col(0);
  y.bottomRows(100).array() += 50;
  const Record record = record_of(u, y);
  EXPECT_NEAR(static_regression(record, {0, 100}).D(0, 0), 2, 1e-12);
}

TEST(StaticRegression, SharesTheGainAmongInputsThatFollowFromOneAnotherAndLeavesStillOnesOut) {
  Matrix u(200, 3);
  u.leftCols(1) = inputs(200).leftCols(1);
  u.col(1) = u.col(0);
  u.col(2).setConstant(5);
  const Record record = record_of(u, 2 * u.col(0));
  const StateSpaceModel model = static_regression(record, record.all());
  EXPECT_NEAR(model.D(0, 0), 1, 1e-9);
  EXPECT_NEAR(model.D(0, 1), 1, 1e-9);
  EXPECT_EQ(model.D(0, 2), 0);
}

}  // namespace
}  // namespace reident::identification::static_regression_test
