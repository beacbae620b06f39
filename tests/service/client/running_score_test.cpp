#include "service/client/running_score.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reident::test::running_score_test {
namespace {

using identification::Matrix;
using identification::Vector;

TEST(RunningScore, IsTheScoreOfTheIdentification) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Matrix y(500, 2);
  Matrix y_hat(500, 2);
  RunningScore running(2);
  for (Eigen::Index row = 0; row < y.rows(); ++row) {
    for (Eigen::Index q = 0; q < 2; ++q) {
      y(row, q) = 28 + normal(random);
      y_hat(row, q) = y(row, q) + 0.3 * normal(random);
    }
    running.add(y.row(row).transpose(), y_hat.row(row).transpose());
  }
  const identification::Score expected = identification::score(y, y_hat);
  const identification::Score score = running.score();
  EXPECT_EQ(score.rows, 500);
  for (Eigen::Index q = 0; q < 2; ++q) {
    EXPECT_NEAR(score.mrse_percent(q), expected.mrse_percent(q), 1e-9);
    EXPECT_NEAR(score.fit_percent(q), expected.fit_percent(q), 1e-9);
  }
}

TEST(RunningScore, DoesNotExistBeforeTheFirstSampleAndLeavesOutWhatIsMissing) {
  RunningScore running(1);
  EXPECT_TRUE(std::isnan(running.score().mrse()));
  running.add(Vector::Constant(1, NAN), Vector::Constant(1, 3));
  EXPECT_EQ(running.rows(), 0);
  running.add(Vector::Constant(1, 2), Vector::Constant(1, 3));
  EXPECT_DOUBLE_EQ(running.score().mrse(), 50);
  EXPECT_TRUE(std::isnan(running.score().fit())) << "one value has no variance";
}

TEST(RunningScore, OfAZeroOutputThatIsMetIsZero) {
  RunningScore running(1);
  running.add(Vector::Zero(1), Vector::Zero(1));
  EXPECT_EQ(running.score().mrse(), 0);
}

}  // namespace
}  // namespace reident::test::running_score_test
