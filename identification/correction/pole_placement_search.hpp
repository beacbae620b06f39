// Correction by pole placement: the search of the paper's section 3.3 (METHOD.md, section 13).
//
// The input of the model gets the feedback of its own state, u - u0 = N w - F x, where w is the
// input less its operating point. The result is a plain model of the same order that runs free:
//
//   x[k+1] = (A - B F) x[k] + B N (u[k] - u0)
//   y[k]   = (C - D F) x[k] + D N (u[k] - u0) + y0
//
// F (m x n) puts each pole z at z^s, the paper's eigenvalue times a scale s. N (m x m) is I, as in
// the paper's figure 6, or the N nearest to I that keeps the static gain. Nothing here throws.
#pragma once

#include <complex>
#include <optional>

#include "identification/correction/pole_placement.hpp"
#include "identification/numerics/for_each.hpp"
#include "identification/samples/record.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// A correction counts where its error is below this share of the plain one.
inline constexpr double worthwhile = 0.99;

/// Returns z^scale. The angle of a pair stays where scale times it would reach half of the sample
/// rate. A real negative pole keeps its sign, and one below 1e-8 stays.
std::complex<double> scaled_pole(std::complex<double> pole, double scale);
Poles scaled_poles(const Poles& poles, double scale);

/// A corrected model, how it was made and how well it runs.
struct Correction {
  StateSpaceModel model;  // without K: that of the plain model belongs to its A and C
  double scale = 1;
  bool keeps_static_gain = false;
  Matrix gain;           // F, m x n
  Matrix input_gain;     // N, m x m
  Score error;           // of the free run over the tuning rows
  Poles uncontrollable;  // poles that no input reaches and that stayed
};

/// What the search found.
struct CorrectionSearch {
  Score plain;                     // of the model as it is, over the same rows
  std::optional<Correction> best;  // absent where none lowers the error by more than 1 %
};

/// Tries the 11 scales 10^-1, 10^-0.8, ... 10^1 with both N, then those in steps of 10^0.05 next to
/// the best. Returns the one of least MRSE over the rows `tune` among models that are stable. At
/// most the last 20,000 rows of `identify` and the first 20,000 of `tune` count. y0 moves so that
/// the mean residual over the rows of `identify` stays. The result does not depend on `for_each`.
/// Requires a stable, well-formed model, finite rows, neither range empty, and `tune` behind
/// `identify`.
CorrectionSearch search_correction(const StateSpaceModel& model, const Record& record,
                                   RowRange identify, RowRange tune,
                                   const ForEach& for_each = in_sequence);

}  // namespace reident::identification
