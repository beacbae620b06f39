#include "identification/subspace/kalman.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::kalman_test {
namespace {

Matrix covariance(test::Noise& noise, Index size) {
  const Matrix root = noise.normal(size, size);
  return root * root.transpose();
}

TEST(Kalman, TheSolutionSatisfiesTheRiccatiEquation) {
  test::Noise noise(7);
  for (Index n = 1; n <= 12; ++n) {
    const Index p = 1 + n % 3;
    const StateSpaceModel model = test::random_system(noise, n, 1, p, 0.999);
    const Matrix W = covariance(noise, n + p);
    const auto P = riccati_solution(model.A, model.C, W);
    ASSERT_TRUE(P) << n;
    const Matrix Q = W.topLeftCorner(n, n), S = W.topRightCorner(n, p);
    const Matrix R = W.bottomRightCorner(p, p);
    const Matrix cross = model.A * *P * model.C.transpose() + S;
    const Matrix innovation = model.C * *P * model.C.transpose() + R;
    const Matrix back =
        model.A * *P * model.A.transpose() + Q - cross * innovation.inverse() * cross.transpose();
    EXPECT_LT((back - *P).norm(), 1e-8 * P->norm()) << n;
    EXPECT_GT(P->selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-10 * P->norm());
  }
}

TEST(Kalman, TheScalarGainIsTheClosedForm) {
  const Matrix A = Matrix::Constant(1, 1, 0.9), C = Matrix::Ones(1, 1);
  Matrix W = Matrix::Identity(2, 2);
  // P = 0.81 P + 1 - 0.81 P^2 / (P + 1), so P^2 - 0.81 P - 1 = 0.
  const double P = (0.81 + std::sqrt(0.81 * 0.81 + 4)) / 2;
  const auto K = kalman_gain(A, C, W);
  ASSERT_TRUE(K);
  EXPECT_NEAR((*K)(0, 0), 0.9 * P / (P + 1), 1e-12);
}

TEST(Kalman, AnUnstableSystemIsStabilised) {
  const Matrix A = Matrix::Constant(1, 1, 1.5), C = Matrix::Ones(1, 1);
  const auto K = kalman_gain(A, C, Matrix::Identity(2, 2));
  ASSERT_TRUE(K);
  EXPECT_LT(std::abs(1.5 - (*K)(0, 0)), 1);
}

TEST(Kalman, NoMeasurementNoiseGivesNoGain) {
  const Matrix A = Matrix::Constant(1, 1, 0.5), C = Matrix::Ones(1, 1);
  Matrix W = Matrix::Zero(2, 2);
  EXPECT_FALSE(kalman_gain(A, C, W));
  W(0, 0) = 1;
  EXPECT_FALSE(kalman_gain(A, C, W));
}

TEST(Kalman, ACopyOfAnOutputAddsNothing) {
  test::Noise noise(8);
  const StateSpaceModel model = test::random_system(noise, 3, 1, 2);
  const Matrix W = covariance(noise, 5);
  Matrix copied = Matrix::Identity(6, 5);
  copied.row(5) = 2.5 * copied.row(3);
  const Matrix C = copied.bottomRightCorner(3, 2) * model.C;
  const auto K = kalman_gain(model.A, model.C, W);
  const auto of_three = kalman_gain(model.A, C, copied * W * copied.transpose());
  ASSERT_TRUE(K && of_three);
  // Errors of the outputs that are the same correct the state alike.
  EXPECT_LT((*of_three * copied.bottomRightCorner(3, 2) - *K).norm(), 1e-6 * K->norm());
}

}  // namespace
}  // namespace reident::identification::kalman_test
