// The search over order, horizon, weighting and the way of B and D, scored on rows that no
// candidate has seen.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "identification/lag_sums.hpp"
#include "identification/normalise.hpp"
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
  std::vector<bool> direct;  // D free, D zero, or both
  Stability stability = Stability::as_found;
};

/// Runs task(0), ..., task(count - 1) in any order, on as many threads as it likes, and returns
/// when all are done.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

/// What the search works on. `sums` are of the three stretches between the folds' edges.
struct SearchData {
  const Record& normalised;
  const Normalisation& normalisation;
  const std::array<Fold, 2>& folds;
  const std::array<StretchSums, 3>& sums;
};

/// How far the search goes, in multiply-adds of free runs and regressions.
struct SearchEffort {
  double budget = 0;
  double spent = 0;
};

/// Fits recipes on each fold of a normalised record and scores their free runs on the rows held
/// out, in three stages: every order, horizon and weighting with B and D from the compression; the
/// best of these with B and D from the simulated output; the best of all with A and C refined.
/// Returns those that are stable on both folds, best first: within 1 % of the smallest error, or
/// below 1e-6, the lower order wins, then the lower error. A recent operating point is taken where
/// it lowers the error by more than 5 %, a refinement where it lowers it by more than 1 %. Where
/// the budget does not allow to score all on all rows held out, the first stage scores on those
/// nearest to the rows fitted.
std::vector<ScoredRecipe> ranked_recipes(const SearchData& data, const SearchSpace& space,
                                         const ForEach& for_each, SearchEffort& effort);

/// The error of the model that says the mean of the fitted rows. An error is the mean over folds
/// and outputs of the root mean square on the rows held out, in units of the output's deviation.
double held_out_error_of_constant(const Record& normalised, const std::array<Fold, 2>& folds);

/// Shifts the model's y0 to the operating point of the last half (`towards_end`) or the first half
/// of the rows it was fitted on, given the fit's residuals there.
Vector recent_operating_point(const Matrix& residuals, bool towards_end);

/// The factor of the horizon's Hankel rows: of the sums, or of the rows where sums lose too much.
HankelFactor compress(const StretchSums& sums, const Normalisation& normalisation,
                      const Record& normalised, const std::vector<Segment>& segments,
                      Index horizon);

}  // namespace reident::identification
