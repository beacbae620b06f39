// A discrete-time, linear, time-invariant state-space model with its operating point:
//
//   x[k+1] = A x[k] + B (u[k] - u0)
//   y[k]   = C x[k] + D (u[k] - u0) + y0
//
//   | symbol | size  | unit                                    |
//   |--------|-------|-----------------------------------------|
//   | A      | n x n | 1                                       |
//   | B      | n x m | state unit / input unit                 |
//   | C      | p x n | output unit / state unit                |
//   | D      | p x m | output unit / input unit                |
//   | K      | n x p | state unit / output unit; empty if none |
//   | u0     | m     | input units                             |
//   | y0     | p     | output units                            |
//
// n, m and p are the order and the numbers of inputs and outputs. The basis of x is arbitrary.
#pragma once

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

struct StateSpaceModel {
  Matrix A, B, C, D;
  Matrix K;       // Kalman gain of the innovations form; 0 x 0 where none exists
  Vector u0, y0;  // operating point
  double period_s = 0;

  Index order() const { return A.rows(); }
  Index inputs() const { return D.cols(); }
  Index outputs() const { return D.rows(); }
};

/// Largest |eigenvalue| of A; 0 for an order of 0. The model is stable when it is below 1.
double spectral_radius(const StateSpaceModel& model);

/// Seconds in which the slowest mode falls to 1/e of what it was: 0 for a spectral radius of 0,
/// infinite where the model is not stable.
double slowest_time_constant_s(const StateSpaceModel& model);
double slowest_time_constant_s(const Matrix& A, double period_s);

/// Every eigenvalue of the square, finite or non-finite matrix A lies inside the unit circle.
bool is_stable(const Matrix& A);

/// Sizes agree, every number is finite and the period is positive.
bool is_well_formed(const StateSpaceModel& model);

}  // namespace reident::identification
