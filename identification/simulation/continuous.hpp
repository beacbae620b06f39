// Continuous time: the differential equation whose samples, with inputs held from one sample to the
// next (zero-order hold), are those of a discrete-time model.
//
//   dx/dt = A x + B (u - u0)
//   y     = C x + D (u - u0) + y0
//
//   | symbol | size  | unit                              |
//   |--------|-------|-----------------------------------|
//   | A      | n x n | 1/s                               |
//   | B      | n x m | state unit / (input unit and s)   |
//   | C      | p x n | output unit / state unit          |
//   | D      | p x m | output unit / input unit          |
//   | u0     | m     | input units                       |
//   | y0     | p     | output units                      |
//
// The state is that of the discrete-time model, and so are C, D, u0 and y0. With the period T
//
//   [A_d B_d; 0 I] = exp([A B; 0 0] T)
//
// holds for every A, an integrator included, since nothing divides by A_d - I (C. F. Van Loan,
// "Computing integrals involving the matrix exponential", IEEE Transactions on Automatic Control
// 23(3), 1978). The way back is the principal logarithm of the same matrix (N. J. Higham,
// "Functions of Matrices", SIAM, 2008, chapter 11): of all differential equations with these
// samples the one whose poles stay below half of the sample rate.
//
// There is no K. The gain of a continuous-time predictor belongs to measurements that never cease;
// the noise that K stands for is known at the samples alone, and many intensities between them
// agree with it. A predictor runs on the discrete-time model.
#pragma once

#include <variant>

#include "identification/samples/verdict.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

struct ContinuousModel {
  Matrix A, B, C, D;
  Vector u0, y0;  // operating point

  Index order() const { return A.rows(); }
  Index inputs() const { return D.cols(); }
  Index outputs() const { return D.rows(); }
};

/// Requires a well-formed model. The verdict no_continuous_time is given where
///   - a pole is below 1e-8: it is gone within one sample, as no differential equation of the same
///     order is;
///   - a pole is real and negative: it turns its sign with every sample. (A pair of equal ones has
///     real logarithms, but infinitely many, and whether a pair is equal is decided by rounding.)
///   - the logarithm put back into the exponential misses A and the columns of B by more than 1e-9
///     of their sizes in all.
std::variant<ContinuousModel, Verdict> to_continuous(const StateSpaceModel& model);

/// The samples of the model every `period_s` > 0 seconds; without K.
StateSpaceModel to_discrete(const ContinuousModel& model, double period_s);

}  // namespace reident::identification
