#include "identification/subspace/noise_covariance.hpp"

#include <gtest/gtest.h>

#include "identification/subspace/kalman.hpp"
#include "tests/identification/subspace/plain_compression.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::noise_covariance_test {
namespace {

TEST(Subspace, FindsTheKalmanGainOfAnInnovationsForm) {
  test::Noise noise(4);
  StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.8);
  truth.K = kalman_gain(truth.A, truth.C, Matrix::Identity(3, 3)).value();
  const Index rows = 40000;
  Record record = contiguous_record(1, noise.normal(rows, 1), Matrix(rows, 1));
  Vector x = Vector::Zero(2);
  for (Index k = 0; k < rows; ++k) {
    const double e = 0.5 * noise.normal();
    record.y(k, 0) = (truth.C * x + truth.D * record.u.row(k).transpose())(0) + e;
    x = truth.A * x + truth.B * record.u.row(k).transpose() + truth.K * e;
  }
  const Projection projection(test::compressed(record, 15));
  const Matrix W = noise_covariance(projection, truth);
  EXPECT_NEAR(W(2, 2), 0.25, 0.02) << "the innovation's variance";
  const auto K = kalman_gain(truth.A, truth.C, W);
  ASSERT_TRUE(K);
  EXPECT_LT((*K - truth.K).norm(), 0.05);
}

}  // namespace
}  // namespace reident::identification::noise_covariance_test
