// Correction by pole placement: the search of the paper's section 3.3.
//
// The input of the model gets the feedback of its own state, u - u0 = N w - F x, where w is the
// input less its operating point. The result is a plain model of the same order that runs free:
//
//   x[k+1] = (A - B F) x[k] + B N (u[k] - u0)
//   y[k]   = (C - D F) x[k] + D N (u[k] - u0) + y0
//
// F (m x n) puts each pole z at z^s, which is exp(s lambda T) where z = exp(lambda T): the paper's
// eigenvalue times a scale s. N (m x m) is I, as in the paper's figure 6, which changes the
// static gain along with the poles; or the N nearest to I, each input measured by its standard
// deviation, that keeps the static gain.
#pragma once

#include <complex>
#include <optional>

#include "identification/correction/pole_placement.hpp"
#include "identification/numerics/for_each.hpp"
#include "identification/samples/record.hpp"
#include "identification/simulation/simulate.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// A correction that lowers the error by less than 1 % is none.
inline constexpr double worthwhile = 0.99;

/// z^scale of a positive real pole and of complex ones; the angle of a pair stays where scale times
/// it would reach half of the sample rate. sign(z) |z|^scale of a negative one: it turns with every
/// sample and is that of no differential equation. A pole below 1e-8 is gone within a sample and
/// stays.
std::complex<double> scaled_pole(std::complex<double> pole, double scale);
Poles scaled_poles(const Poles& poles, double scale);

/// C (I - A)^-1 B + D, absent where a pole is so near to 1 that it says nothing.
std::optional<Matrix> static_gain(const StateSpaceModel& model);

struct Correction {
  /// Without K: that of the model corrected belongs to the noise as it enters its A and C, and no
  /// noise model of the corrected A and C is known.
  StateSpaceModel model;
  double scale = 1;
  bool keeps_static_gain = false;
  Matrix gain;           // F
  Matrix input_gain;     // N
  Score error;           // of the free run over the tuning rows
  Poles uncontrollable;  // poles that no input reaches and that stayed
};

struct CorrectionSearch {
  Score plain;                     // of the model as it is, over the same rows
  std::optional<Correction> best;  // absent where none lowers the error by more than 1 %
};

/// Tries the 11 scales 10^-1, 10^-0.8, ... 10^1 with both N, then those in steps of 10^0.05 beside
/// the best, and takes the one of least MRSE over the rows `tune`, among models that are stable.
/// Every model runs freely from the first of the rows looked at on: at most the last 20,000 of
/// `identify` and the first 20,000 of `tune`, which follow `identify`. y0 moves by as much as the
/// mean residual over the `identify` rows moved, so that the operating point found there stays.
/// The result does not depend on `for_each`.
/// Requires a stable, well-formed model, finite rows, and neither range empty.
CorrectionSearch search_correction(const StateSpaceModel& model, const Record& record,
                                   RowRange identify, RowRange tune,
                                   const ForEach& for_each = in_sequence);

}  // namespace reident::identification
