// The search over order, horizon, weighting and the way of B and D, scored on rows that no
// candidate has seen.
#pragma once

#include <cstddef>
#include <vector>

#include "identification/numerics/for_each.hpp"
#include "identification/samples/record.hpp"
#include "identification/search/folds.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/normalise.hpp"
#include "identification/subspace/subspace.hpp"

namespace reident::identification {

/// Where the output's operating point is taken from: all rows, or the half of them nearest to the
/// rows that the model is meant for, which follows an output whose zero drifts.
enum class OperatingPoint { whole, recent };

/// What B and D are fitted to: the projected future outputs of the compression, or the simulated
/// output, together with the offset and the initial states.
enum class ResponseFit { subspace, simulation };

/// What is chosen: with it and the rows, the model follows.
struct Recipe {
  int order = 0;
  int horizon = 0;
  Weighting weighting = Weighting::n4sid;
  Stability stability = Stability::as_found;
  ResponseFit fit = ResponseFit::subspace;
  bool direct = true;  // D is free
  OperatingPoint operating_point = OperatingPoint::whole;
  int refinement_steps = 0;  // at most so many Levenberg-Marquardt steps on A and C,
  Index refined_rows = 0;    // from no more than so many rows, those nearest to the end
};

struct ScoredRecipe {
  Recipe recipe;
  double error = 0;  // mean over the folds of HeldOutErrors
};

struct SearchSpace {
  std::vector<int> horizons;  // ascending
  std::vector<Weighting> weightings;
  int min_order = 1;
  int max_order = 1;
  std::vector<bool> direct;       // D free, D zero, or both
  std::vector<ResponseFit> fits;  // either or both
  Stability stability = Stability::as_found;
};

/// What the search works on. `sums` are of the rows that each fold fits.
struct SearchData {
  const Record& normalised;
  const Normalisation& normalisation;
  const std::vector<Fold>& folds;
  const std::vector<StretchSums>& sums;
};

/// How far the search goes, in multiply-adds of free runs and regressions. A third of the budget is
/// each stage's.
struct SearchEffort {
  double budget = 0;
  double spent = 0;
};

/// Multiply-adds that one row takes in the regression on the simulated output, refinement included,
/// with m inputs and p outputs.
double work_of_regression(const Recipe& recipe, Index m, Index p);

/// Rows that `work` multiply-adds of the regression last for; never fewer than 2000, however small
/// the budget.
Index affordable_rows(const Recipe& recipe, Index m, Index p, double work);

/// Fits recipes on each fold of a normalised record and scores their free runs on the rows held
/// out, in three stages: every order, horizon and weighting with B and D from the compression; the
/// best of these with B and D either way; the best of these with A and C refined. Returns those
/// that are stable on every fold, best first:
///   - within 0.2 % of the smallest error, or below 1e-6, the lower order wins, then the lower
///   error;
///   - a recent operating point is taken where it lowers the error by more than 5 %;
///   - a refinement is taken where it lowers the error by more than 1 %.
/// Where the budget does not last for all, fewer rows are fitted and scored, those beside the
/// folds' edges, and then fewer recipes.
std::vector<ScoredRecipe> ranked_recipes(const SearchData& data, const SearchSpace& space,
                                         const ForEach& for_each, SearchEffort& effort);

}  // namespace reident::identification
