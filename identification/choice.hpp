// The search over order, horizon and weighting, scored on rows that no candidate has seen.
#pragma once

#include <array>
#include <vector>

#include "identification/identify.hpp"
#include "identification/record.hpp"
#include "identification/subspace.hpp"

namespace reident::identification {

/// A model is fitted on `fit` and scored on `tune`, the rows just before or just after.
struct Fold {
  RowRange fit;
  RowRange tune;
};

/// The two folds of `rows` rows: the last `tune_share` held out, and the first.
std::array<Fold, 2> folds_of(Index rows, double tune_share);

/// Where the output's operating point is taken from: all rows, or the half of them nearest to the
/// rows that the model is meant for, which follows an output whose zero drifts.
enum class OperatingPoint { whole, recent };

/// What is chosen: with it and the rows, the model follows.
struct Recipe {
  int order = 0;
  int horizon = 0;
  Weighting weighting = Weighting::n4sid;
  Stability stability = Stability::as_found;
  OperatingPoint operating_point = OperatingPoint::whole;
  int refinement_steps = 0;  // at most so many Levenberg-Marquardt steps on A and C
};

struct ScoredRecipe {
  Recipe recipe;
  double error = 0;  // see held_out_error_of_constant
};

struct SearchSpace {
  std::vector<int> horizons;  // ascending
  std::vector<Weighting> weightings;
  int min_order = 1;
  int max_order = 1;
  Stability stability = Stability::as_found;
  int refinement_steps = 0;
};

/// Fits every recipe on each fold of a normalised record and scores its free run on the rows held
/// out. Returns those that are stable on both folds, best first: within 1 % of the smallest error,
/// or below 1e-6, the lower order wins, then the lower error, then the shorter horizon. A recent
/// operating point is taken where it lowers the error by more than 5 %. Where refining the best
/// recipe lowers its error by more than 1 %, the refined one comes before it.
std::vector<ScoredRecipe> ranked_recipes(const Record& normalised, const std::array<Fold, 2>& folds,
                                         const SearchSpace& space);

/// The error of the model that says the mean of the fitted rows. An error is the mean over folds
/// and outputs of the root mean square on the rows held out, in units of the output's deviation.
double held_out_error_of_constant(const Record& normalised, const std::array<Fold, 2>& folds);

/// Shifts the model's y0 to the operating point of the last half (`towards_end`) or the first half
/// of the rows it was fitted on, given the fit's residuals there.
Vector recent_operating_point(const Matrix& residuals, bool towards_end);

}  // namespace reident::identification
