// Decompositions of dense matrices and the solutions of equations by them.
//
// Eigen's decompositions are templates that take minutes to compile. They are compiled once, in
// decompositions.cpp; other files include this header in place of Eigen's. A right-hand side that
// is a vector, one that is a matrix of one column and one that is a transposed matrix are solved by
// different loops, whose results differ in their last bits. Sizes have to agree; nothing throws.
#pragma once

#include <complex>
#include <optional>
#include <utility>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

using ComplexVector = Eigen::VectorXcd;

/// The upper triangular R (min(m, n) x n) of the Householder factorisation A = Q R of an m x n
/// matrix.
Matrix triangular_factor(const Matrix& A);
/// The m x m orthogonal Q of A = Q R.
Matrix orthogonal_factor(const Matrix& A);
/// The first n columns of Q of A = Q R, m >= n: an orthonormal basis of A's columns.
Matrix orthonormal_basis(const Matrix& A);

/// Least-squares solution X (n x k) of A X = B for an m x n matrix A of full column rank.
Vector solve_qr(const Matrix& A, const Vector& b);
/// Least-squares solution by a factorisation with column pivoting; unknowns that A does not
/// determine are 0.
Vector solve_pivoted_qr(const Matrix& A, const Vector& b);
Matrix solve_pivoted_qr(const Matrix& A, const Matrix& B);
/// Least-squares solution of least norm, by the complete orthogonal decomposition; A may be empty.
Vector solve_least_norm(const Matrix& A, const Vector& b);
Matrix solve_least_norm(const Matrix& A, const Matrix& B);
Matrix pseudo_inverse(const Matrix& A);
/// The X of least norm with X A = M, in the sense of least squares.
Matrix solve_least_norm_on_right(const Matrix& M, const Matrix& A);

/// Solution of A X = B for a square, regular A, by LU with row pivoting.
Matrix solve_lu(const Matrix& A, const Matrix& B);
std::pair<Matrix, Matrix> solve_lu(const Matrix& A, const Matrix& B, const Matrix& C);
/// Solution of A X = B for a square A by LU with full pivoting.
Vector solve_full_lu(const Matrix& A, const Vector& b);
Matrix solve_full_lu(const Matrix& A, const Matrix& B);
/// Absent where the reciprocal of A's condition number is not above `least_rcond`.
std::optional<Matrix> solve_full_lu(const Matrix& A, const Matrix& B, double least_rcond);
/// The X with X A = M for a symmetric, positive semi-definite A, by LDL'.
Matrix solve_ldlt_on_right(const Matrix& M, const Matrix& A);
/// The X with X L = M for a lower triangular, regular L.
Matrix solve_lower_on_right(const Matrix& M, const Matrix& L);

/// A = L L' of a symmetric, positive definite matrix, of which the lower triangle is read.
class Cholesky {
 public:
  /// Absent where A is not positive definite, a diagonal entry of L is not above `least_pivot`, or
  /// the reciprocal of A's condition number not above `least_rcond`.
  static std::optional<Cholesky> of(const Matrix& A, double least_pivot, double least_rcond = 0);
  Vector solve(const Vector& b) const;
  Matrix solve(const Matrix& B) const;
  /// The X with A X = M'.
  Matrix solve_transposed(const Matrix& M) const;

 private:
  Matrix L_;
};

/// A = V diag(values) V' of a symmetric matrix, of which the lower triangle is read.
struct SymmetricEigen {
  Vector values;  // ascending
  Matrix vectors;
  bool converged = false;
};
SymmetricEigen symmetric_eigen(const Matrix& A);

/// A = U diag(values) V' with values descending. U is m x min(m, n), or m x m where it is `full`.
struct LeftSingular {
  Matrix U;
  Vector values;
};
enum class SingularVectors { thin, full };
LeftSingular left_singular(const Matrix& A, SingularVectors vectors);
Vector singular_values(const Matrix& A);
/// The unit v for which |A v| is least.
Eigen::Vector2d least_right_singular(const Eigen::Matrix2d& A);

/// Powers of 2, d, with which row and column i of diag(d)^-1 A diag(d) have about the same size,
/// for a square matrix (B. N. Parlett, C. Reinsch, Numerische Mathematik 13, 1969).
Vector balancing(const Matrix& A);

/// Eigenvalues of a square matrix, in no order.
ComplexVector eigenvalues(const Matrix& A);
/// Largest |eigenvalue| of a square matrix; 0 of an empty one, NaN where it is not finite.
double spectral_radius(const Matrix& A);

/// A = Q T Q' with T upper triangular but for diagonal blocks of two rows. Absent where the
/// iteration does not converge.
struct RealSchur {
  Matrix T, Q;
};
std::optional<RealSchur> real_schur(const Matrix& A);

Matrix matrix_exponential(const Matrix& A);
/// The principal logarithm; A has no eigenvalue on the closed negative real axis.
Matrix matrix_logarithm(const Matrix& A);

}  // namespace reident::identification
