// The Kalman gain of the innovations form (METHOD.md, section 8). Requires A (n x n), C (p x n) and
// the noise covariance [Q S; S' R] (n + p square). Nothing here throws.
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Returns the stabilising solution P (n x n) of the filter's Riccati equation. Absent where R is
/// singular, the noise is not finite or P leaves a relative residual of 1e-8 or more.
std::optional<Matrix> riccati_solution(const Matrix& A, const Matrix& C, const Matrix& noise);

/// Returns K (n x p). Absent where there is no P or where A - K C is not stable.
std::optional<Matrix> kalman_gain(const Matrix& A, const Matrix& C, const Matrix& noise);

}  // namespace reident::identification
