#include "identification/numerics/decompositions.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <unsupported/Eigen/MatrixFunctions>

namespace reident::identification {

Matrix triangular_factor(const Matrix& A) {
  // More rows at once leave the cache.
  const Index at_once = std::max<Index>(512, 4 * A.cols());
  if (A.rows() > 2 * at_once) {
    Matrix rows(at_once + A.cols(), A.cols());
    Index factored = 0;  // rows of the factor of those before
    for (Index begin = 0; begin < A.rows(); begin += at_once) {
      const Index count = std::min(at_once, A.rows() - begin);
      rows.middleRows(factored, count) = A.middleRows(begin, count);
      const Matrix factor = triangular_factor(rows.topRows(factored + count));
      factored = factor.rows();
      rows.topRows(factored) = factor;
    }
    return rows.topRows(factored);
  }
  const Eigen::HouseholderQR<Matrix> qr(A);
  return qr.matrixQR().topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

Matrix orthogonal_factor(const Matrix& A) {
  return Eigen::HouseholderQR<Matrix>(A).householderQ();
}

Matrix orthonormal_basis(const Matrix& A) {
  return Eigen::HouseholderQR<Matrix>(A).householderQ() * Matrix::Identity(A.rows(), A.cols());
}

Vector solve_qr(const Matrix& A, const Vector& b) {
  return Eigen::HouseholderQR<Matrix>(A).solve(b);
}

Vector solve_pivoted_qr(const Matrix& A, const Vector& b) {
  return Eigen::ColPivHouseholderQR<Matrix>(A).solve(b);
}

Matrix solve_pivoted_qr(const Matrix& A, const Matrix& B) {
  return Eigen::ColPivHouseholderQR<Matrix>(A).solve(B);
}

Vector solve_least_norm(const Matrix& A, const Vector& b) {
  if (A.size() == 0) return Vector::Zero(A.cols());
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(A).solve(b);
}

Matrix solve_least_norm(const Matrix& A, const Matrix& B) {
  if (A.size() == 0) return Matrix::Zero(A.cols(), B.cols());
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(A).solve(B);
}

Matrix pseudo_inverse(const Matrix& A) {
  return solve_least_norm(A, Matrix(Matrix::Identity(A.rows(), A.rows())));
}

Matrix solve_least_norm_on_right(const Matrix& M, const Matrix& A) {
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(A.transpose())
      .solve(M.transpose())
      .transpose();
}

Matrix solve_lu(const Matrix& A, const Matrix& B) {
  return Eigen::PartialPivLU<Matrix>(A).solve(B);
}

std::pair<Matrix, Matrix> solve_lu(const Matrix& A, const Matrix& B, const Matrix& C) {
  const Eigen::PartialPivLU<Matrix> lu(A);
  return {lu.solve(B), lu.solve(C)};
}

Vector solve_full_lu(const Matrix& A, const Vector& b) {
  return Eigen::FullPivLU<Matrix>(A).solve(b);
}

Matrix solve_full_lu(const Matrix& A, const Matrix& B) {
  return Eigen::FullPivLU<Matrix>(A).solve(B);
}

std::optional<Matrix> solve_full_lu(const Matrix& A, const Matrix& B, double least_rcond) {
  const Eigen::FullPivLU<Matrix> lu(A);
  // Eigen's rcond() is no estimate where the matrix is singular.
  if (!lu.isInvertible() || !(lu.rcond() > least_rcond)) return std::nullopt;
  return Matrix(lu.solve(B));
}

Matrix solve_ldlt_on_right(const Matrix& M, const Matrix& A) {
  return Eigen::LDLT<Matrix>(A).solve(M.transpose()).transpose();
}

Matrix solve_lower_on_right(const Matrix& M, const Matrix& L) {
  return L.triangularView<Eigen::Lower>().solve<Eigen::OnTheRight>(M);
}

std::optional<Cholesky> Cholesky::of(const Matrix& A, double least_pivot, double least_rcond) {
  const Eigen::LLT<Matrix> llt(A);
  if (llt.info() != Eigen::Success) return std::nullopt;
  if (A.rows() > 0 && !(llt.matrixLLT().diagonal().minCoeff() > least_pivot)) return std::nullopt;
  if (least_rcond > 0 && !(llt.rcond() > least_rcond)) return std::nullopt;
  Cholesky result;
  result.L_ = llt.matrixLLT();
  return result;
}

Vector Cholesky::solve(const Vector& b) const {
  Vector x = L_.triangularView<Eigen::Lower>().solve(b);
  L_.triangularView<Eigen::Lower>().adjoint().solveInPlace(x);
  return x;
}

Matrix Cholesky::solve(const Matrix& B) const {
  Matrix X = L_.triangularView<Eigen::Lower>().solve(B);
  L_.triangularView<Eigen::Lower>().adjoint().solveInPlace(X);
  return X;
}

Matrix Cholesky::solve_transposed(const Matrix& M) const {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> X = M.transpose();
  L_.triangularView<Eigen::Lower>().solveInPlace(X);
  L_.triangularView<Eigen::Lower>().adjoint().solveInPlace(X);
  return X;
}

SymmetricEigen symmetric_eigen(const Matrix& A) {
  if (A.rows() == 0) return {Vector(0), Matrix(0, 0), true};
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors(), eigen.info() == Eigen::Success};
}

LeftSingular left_singular(const Matrix& A, SingularVectors vectors) {
  const Eigen::JacobiSVD<Matrix> svd(
      A, vectors == SingularVectors::thin ? Eigen::ComputeThinU : Eigen::ComputeFullU);
  return {svd.matrixU(), svd.singularValues()};
}

Vector singular_values(const Matrix& A) {
  return Eigen::JacobiSVD<Matrix>(A).singularValues();
}

Eigen::Vector2d least_right_singular(const Eigen::Matrix2d& A) {
  return Eigen::JacobiSVD<Eigen::Matrix2d>(A, Eigen::ComputeFullV).matrixV().col(1);
}

Vector balancing(const Matrix& A) {
  constexpr double worth_it = 0.95;
  Matrix sizes = A.cwiseAbs();
  sizes.diagonal().setZero();
  Vector d = Vector::Ones(A.rows());
  for (bool changed = true; changed;) {
    changed = false;
    for (Index i = 0; i < A.rows(); ++i) {
      const double row = sizes.row(i).sum(), column = sizes.col(i).sum();
      if (!(row > 0 && column > 0 && std::isfinite(row + column))) continue;
      const double factor = std::exp2(std::round(std::log2(row / column) / 2));
      if (!(row / factor + column * factor < worth_it * (row + column))) continue;
      sizes.row(i) /= factor;
      sizes.col(i) *= factor;
      d(i) *= factor;
      changed = true;
    }
  }
  return d;
}

ComplexVector eigenvalues(const Matrix& A) {
  if (A.rows() == 0) return {};
  return A.eigenvalues();
}

double spectral_radius(const Matrix& A) {
  return A.rows() == 0 ? 0 : eigenvalues(A).cwiseAbs().maxCoeff();
}

std::optional<RealSchur> real_schur(const Matrix& A) {
  const Eigen::RealSchur<Matrix> schur(A);
  if (schur.info() != Eigen::Success) return std::nullopt;
  return RealSchur{schur.matrixT(), schur.matrixU()};
}

Matrix matrix_exponential(const Matrix& A) {
  return A.exp();
}

}  // namespace reident::identification
