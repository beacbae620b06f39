// Continuous time: the differential equation whose samples, with inputs held from one sample to the
// next (zero-order hold), are those of a discrete-time model (METHOD.md, section 10):
//
//   dx/dt = A x + B (u - u0),   y = C x + D (u - u0) + y0
//
// There is no K: many noises between the samples agree with one K. Nothing here throws.
#pragma once

#include <variant>

#include "identification/samples/verdict.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// The state, C, D, u0 and y0 are those of the discrete-time model.
struct ContinuousModel {
  Matrix A;   // n x n, 1/s
  Matrix B;   // n x m, state unit / (input unit and s)
  Matrix C;   // p x n, output unit / state unit
  Matrix D;   // p x m, output unit / input unit
  Vector u0;  // m, input units: operating point
  Vector y0;  // p, output units: operating point

  Index order() const { return A.rows(); }
  Index inputs() const { return D.cols(); }
  Index outputs() const { return D.rows(); }
};

/// Converts by the principal logarithm, so that poles stay below half of the sample rate.
/// Requires a well-formed model. Returns the verdict no_continuous_time where
///   - a pole is below 1e-8: it is gone within one sample;
///   - a pole is real and negative: it turns its sign with every sample;
///   - the logarithm put back into the exponential misses A and the columns of B by more than 1e-9
///     of their sizes in all.
std::variant<ContinuousModel, Verdict> to_continuous(const StateSpaceModel& model);

/// Returns the samples of the model every `period_s` seconds; without K. Requires a model of
/// agreeing sizes and a positive period. An integrator is no special case.
StateSpaceModel to_discrete(const ContinuousModel& model, double period_s);

}  // namespace reident::identification
