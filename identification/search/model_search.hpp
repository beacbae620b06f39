// The search over order, horizon, weighting and the way of B and D, scored on rows that no
// candidate was fitted to (METHOD.md, section 7). Records are normalised; m and p are the inputs
// and outputs that take part. Private to the library. Nothing here throws but what `for_each`
// throws.
#pragma once

#include <cstddef>
#include <vector>

#include "identification/numerics/for_each.hpp"
#include "identification/samples/record.hpp"
#include "identification/search/folds.hpp"
#include "identification/search/recipe.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/normalise.hpp"

namespace reident::identification {

/// A recipe and its error on the held-out rows.
struct ScoredRecipe {
  Recipe recipe;
  double error = 0;  // in deviations of the outputs, mean over the folds
};

/// What may be chosen, with one entry where there is no choice. Nothing is empty. The orders are
/// those from min_order to max_order.
struct SearchSpace {
  std::vector<int> horizons;  // ascending
  std::vector<Weighting> weightings;
  int min_order = 1;
  int max_order = 1;
  std::vector<bool> direct;       // D free, D zero, or both
  std::vector<ResponseFit> fits;  // either or both
  Stability stability = Stability::as_found;
  /// |ln| [1/row] of an eigenvalue: slower modes are left out where nothing shows that the inputs
  /// drive them. 0: none is.
  double least_rate = 0;
};

/// What the search works on: a record of normalised channels, and for each fold the sums, in units,
/// of the rows that it fits.
struct SearchData {
  const Record& normalised;
  const Normalisation& normalisation;
  const std::vector<Fold>& folds;
  const std::vector<RangeSums>& sums;
};

/// How far the search goes, in multiply-adds of free runs and regressions. Each stage has a third
/// of the budget. A search adds to `spent`.
struct SearchEffort {
  double budget = 0;
  double spent = 0;
};

/// Returns the multiply-adds that one row takes in the regression on the simulated output,
/// refinement included, with m inputs and p outputs.
double work_of_regression(const Recipe& recipe, Index m, Index p);

/// Returns the rows that `work` multiply-adds of the regression last for; never fewer than 2000,
/// however small the budget.
Index affordable_rows(const Recipe& recipe, Index m, Index p, double work);

/// Fits recipes on each fold and scores their free runs on the rows held out, in three stages:
/// every order, horizon and weighting with B and D from the compression; the best of these with B
/// and D either way; the best of these with A and C refined. A lower order against which nothing
/// speaks (parsimony.hpp) takes the winner's place, and the one with outputs that weigh by what
/// they err where that errs less. Where the budget does not last for
/// all, fewer rows are fitted and scored, those next to the folds' edges, and then fewer recipes.
/// Requires sums of at least 2 s block rows for every horizon s. Returns the recipes that are
/// stable on every fold, best first by the rules of METHOD.md; empty where there is none. The
/// result does not depend on `for_each`.
std::vector<ScoredRecipe> ranked_recipes(const SearchData& data, const SearchSpace& space,
                                         const ForEach& for_each, SearchEffort& effort);

}  // namespace reident::identification
