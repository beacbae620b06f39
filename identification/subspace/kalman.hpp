// The Kalman gain of the innovations form x[k+1] = A x[k] + B u[k] + K e[k], y[k] = C x[k] + D u[k]
// + e[k].
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// The stabilising solution P of the filter's discrete algebraic Riccati equation
///   P = A P A' + Q - (A P C' + S) (C P C' + R)^-1 (A P C' + S)'
/// for the noise covariance [Q S; S' R] of size (n + p), by structure-preserving doubling (E. Chu,
/// H. Fan, W. Lin, C. Wang, Int. J. Control 77(8), 2004). Absent when R is singular, when the
/// doubling does not settle, or when the solution put back leaves a relative residual above 1e-8.
std::optional<Matrix> riccati_solution(const Matrix& A, const Matrix& C, const Matrix& noise);

/// K = (A P C' + S) (C P C' + R)^-1, absent where there is no P or where A - K C is not stable.
std::optional<Matrix> kalman_gain(const Matrix& A, const Matrix& C, const Matrix& noise);

}  // namespace reident::identification
