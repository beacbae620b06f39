// A discrete-time, linear, time-invariant state-space model with its operating point:
//
//   x[k+1] = A x[k] + B (u[k] - u0)
//   y[k]   = C x[k] + D (u[k] - u0) + y0
//
// n, m and p are the order and the numbers of inputs and outputs. The basis of x is arbitrary.
// Nothing here throws.
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

struct StateSpaceModel {
  Matrix A;             // n x n
  Matrix B;             // n x m, state unit / input unit
  Matrix C;             // p x n, output unit / state unit
  Matrix D;             // p x m, output unit / input unit
  Matrix K;             // n x p, state unit / output unit: Kalman gain; 0 x 0 where none exists
  Vector u0;            // m, input units: operating point
  Vector y0;            // p, output units: operating point
  double period_s = 0;  // from one sample to the next [s]

  Index order() const { return A.rows(); }
  Index inputs() const { return D.cols(); }
  Index outputs() const { return D.rows(); }
};

/// Returns the largest |eigenvalue| of the model's square, finite A; 0 for an order of 0. The model
/// is stable when it is below 1.
double spectral_radius(const StateSpaceModel& model);

/// Returns the seconds in which the slowest mode falls to 1/e of what it was: 0 for a spectral
/// radius of 0, infinite where the model is not stable. Requires a square, finite A.
double slowest_time_constant_s(const StateSpaceModel& model);
double slowest_time_constant_s(const Matrix& A, double period_s);

/// Returns C (I - A)^-1 B + D (p x m). Absent where a pole is so near to 1 that it has no meaning.
std::optional<Matrix> static_gain(const StateSpaceModel& model);

/// Whether every eigenvalue of the square matrix A, which may be non-finite, is inside the unit
/// circle.
bool is_stable(const Matrix& A);

/// Whether sizes agree, every number is finite and the period is positive. Any model may be asked.
bool is_well_formed(const StateSpaceModel& model);

}  // namespace reident::identification
