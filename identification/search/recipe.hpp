// What the search chooses: with a recipe and the rows, the model follows (METHOD.md, section 7).
// The weighting and the stability are those of its sections 5 and 7. A version of the service
// stores its recipe, so that it can be identified again.
#pragma once

#include "identification/numerics/matrix.hpp"
#include "identification/subspace/shift_invariance.hpp"
#include "identification/subspace/weighting.hpp"

namespace reident::identification {

/// Where the output's operating point is taken from: all rows, or the half of them nearest to the
/// rows that the model is meant for, which follows an output whose zero drifts.
enum class OperatingPoint { whole, recent };

/// What B and D are fitted to: the projected future outputs of the compression, or the simulated
/// output, together with the offset and the initial states.
enum class ResponseFit { subspace, simulation };

/// The recipe of a model. What is not chosen by a search may be set by hand.
struct Recipe {
  /// n, and the block rows s of past and future.
  int order = 0;
  int horizon = 0;
  Weighting weighting = Weighting::n4sid;
  Stability stability = Stability::as_found;
  ResponseFit fit = ResponseFit::subspace;
  /// Whether D is free.
  bool direct = true;
  OperatingPoint operating_point = OperatingPoint::whole;
  /// |ln| [1/row] of an eigenvalue, at least: slower modes are left out (METHOD.md, section 7,
  /// "Drift").
  double least_rate = 0;
  /// At most so many Levenberg-Marquardt steps on A and C, from no more than so many rows, those
  /// nearest to the end.
  int refinement_steps = 0;
  Index refined_rows = 0;
  /// Whether the model is refined once more, and B, D and y0 are fitted, with outputs that weigh by
  /// what each of them errs: a quiet one more than a noisy one. Else they weigh by their deviation.
  bool weighted = false;
  /// The order of the refined model of which so many modes are left, without those that the rows
  /// miss least; 0: none is taken out.
  int eliminated_from = 0;
  /// Above 0: the model is that of inputs and outputs without the cosines of up to so many half
  /// periods over the rows (METHOD.md, section 7, "Drift").
  int drift_half_periods = 0;
  /// Returns the order of the model that the subspace gives.
  int subspace_order() const { return eliminated_from > 0 ? eliminated_from : order; }
};

}  // namespace reident::identification
