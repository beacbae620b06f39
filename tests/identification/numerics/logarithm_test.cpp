#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "identification/numerics/decompositions.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::logarithm_test {
namespace {

/// A dense matrix of these eigenvalues, those with an imaginary part in conjugate pairs: a rotated
/// block triangular matrix with `coupling` above its blocks.
Matrix with_eigenvalues(test::Noise& noise, const std::vector<std::complex<double>>& eigenvalues,
                        double coupling) {
  Index n = 0;
  for (const auto& value : eigenvalues) n += value.imag() == 0 ? 1 : 2;
  Matrix T = coupling * noise.normal(n, n).triangularView<Eigen::StrictlyUpper>().toDenseMatrix();
  Index row = 0;
  for (const auto& value : eigenvalues) {
    T(row, row) = value.real();
    if (value.imag() != 0) {
      T(row + 1, row + 1) = value.real();
      T(row, row + 1) = 2 * value.imag();
      T(row + 1, row) = -value.imag() / 2;
      ++row;
    }
    ++row;
  }
  const Matrix Q = orthogonal_factor(noise.normal(n, n));
  return Q * T * Q.transpose();
}

/// |exp(log A) - A| / |A|
double residual(const Matrix& A) {
  return (matrix_exponential(matrix_logarithm(A)) - A).norm() / A.norm();
}

TEST(MatrixLogarithm, TheExponentialGivesTheMatrixBack) {
  constexpr double pi = std::numbers::pi;
  const struct {
    const char* name;
    std::vector<std::complex<double>> eigenvalues;
    double coupling, accepted;
  } cases[] = {
      {"near 1",
       {1 - 1e-9, 1 - 1e-6, 1, std::polar(0.9999, 1e-3), std::polar(1.0, 1e-6)},
       0.1,
       1e-13},
      {"far apart", {1e-4, 0.3, 2, 1e3}, 0.1, 1e-11},
      {"near 0", {1e-7, 0.5}, 0, 1e-13},
      {"fast and slow pairs", {std::polar(0.99, 0.01), std::polar(0.1, 2.0), 0.6}, 0.3, 1e-13},
      {"unstable", {1.5, 20, std::polar(3.0, 1.0)}, 1, 1e-13},
      {"pair near the negative axis", {std::polar(0.7, pi - 1e-7)}, 0, 1e-13},
      {"equal pairs", {std::polar(0.8, 1.0), std::polar(0.8, 1.0)}, 1, 1e-11},
      {"one eigenvalue three times", {0.8, 0.8, 0.8}, 1, 1e-11},
  };
  test::Noise noise(11);
  for (const auto& [name, eigenvalues, coupling, accepted] : cases)
    for (int trial = 0; trial < 20; ++trial)
      EXPECT_LT(residual(with_eigenvalues(noise, eigenvalues, coupling)), accepted) << name;
}

TEST(MatrixLogarithm, IsThePrincipalOne) {
  // Eigenvalues of the logarithm stay between -pi and pi: the turn of 3 a sample stays 3.
  Matrix L(3, 3);
  L << -0.1, 3, 0.5, -3, -0.1, 0.2, 0, 0, -2;
  EXPECT_LT((matrix_logarithm(matrix_exponential(L)) - L).norm(), 1e-12);
}

TEST(MatrixLogarithm, AJordanBlockHasItsClosedForm) {
  const double a = 0.8;
  Matrix A(3, 3), L(3, 3);
  A << a, 1, 0, 0, a, 1, 0, 0, a;
  L << std::log(a), 1 / a, -0.5 / (a * a), 0, std::log(a), 1 / a, 0, 0, std::log(a);
  EXPECT_LT((matrix_logarithm(A) - L).norm(), 1e-14);
  EXPECT_EQ(matrix_logarithm(Matrix(0, 0)).size(), 0);
}

TEST(MatrixLogarithm, IsNotANumberWhereThereIsNone) {
  test::Noise noise(13);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double eigenvalue : {0.0, -0.3, nan})
    EXPECT_TRUE(std::isnan(matrix_logarithm(Matrix::Constant(1, 1, eigenvalue))(0, 0)))
        << eigenvalue;
  EXPECT_FALSE(matrix_logarithm(with_eigenvalues(noise, {-0.3, 0.5, 0.9}, 0.1)).allFinite());
}

}  // namespace
}  // namespace reident::identification::logarithm_test
