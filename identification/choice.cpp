#include "identification/choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "identification/response.hpp"
#include "identification/simulate.hpp"

namespace reident::identification {
namespace {

constexpr double equal_errors = 1.01;
constexpr double no_error = 1e-6;  // of an output's deviation
constexpr double worthwhile_recency = 0.95;
constexpr double worthwhile = 0.99;
constexpr int refinement_steps = 10;
/// Recipes that the second and the third stage look at: as many as a third of the budget each
/// allows, within these limits.
constexpr double least_simulated = 2, most_simulated = 12, least_refined = 1, most_refined = 4;
constexpr Index warm_up = 512;  // fitted rows that a run begins with, so that its state settles
constexpr Index least_scored = 1000;  // rows held out, however small the budget

/// Mean over outputs of the root mean square over rows.
double rms(const Matrix& errors) {
  return errors.colwise().norm().mean() / std::sqrt(double(errors.rows()));
}

/// Errors of one candidate on held-out rows, with both operating points; infinite where the
/// candidate is unstable.
struct FoldErrors {
  double whole = std::numeric_limits<double>::infinity();
  double recent = std::numeric_limits<double>::infinity();
};

bool is_forwards(const Fold& fold) {
  return fold.fit.begin < fold.tune.begin;
}

/// The part of the rows held out that is nearest to the rows fitted.
RowRange nearest(const Fold& fold, Index rows) {
  const Index count = std::min(rows, fold.tune.size());
  return is_forwards(fold) ? RowRange{fold.tune.begin, fold.tune.begin + count}
                           : RowRange{fold.tune.end - count, fold.tune.end};
}

/// Errors of a free run over `scored`, a part of the rows held out, carried on from the fitted rows
/// before it.
Matrix held_out_errors(const StateSpaceModel& model, const Record& record, const Fold& fold,
                       RowRange scored) {
  const Index before =
      is_forwards(fold) ? std::min(warm_up, scored.begin - fold.fit.begin) : Index{0};
  const Matrix y_hat = free_run(model, record, {scored.begin - before, scored.end});
  return record.y.middleRows(scored.begin, scored.size()) - y_hat.bottomRows(scored.size());
}

FoldErrors errors_of(const Response& response, const Record& record, const Fold& fold) {
  const bool forwards = is_forwards(fold);
  const RowRange run{fold.fit.begin, forwards ? fold.tune.end : fold.fit.end};
  const Matrix y_hat = free_run(response.model, record, run, response.x0);
  const Matrix residuals =
      record.y.middleRows(fold.fit.begin, fold.fit.size()) - y_hat.topRows(fold.fit.size());
  const Matrix errors = record.y.middleRows(fold.tune.begin, fold.tune.size()) -
                        (forwards ? Matrix(y_hat.bottomRows(fold.tune.size()))
                                  : free_run(response.model, record, fold.tune));
  const Vector shift = recent_operating_point(residuals, forwards);
  const FoldErrors result{rms(errors), rms(errors.rowwise() - shift.transpose())};
  return std::isfinite(result.whole) ? result : FoldErrors{};
}

/// Multiply-adds of a run of one row.
double work_of_run(Index n, Index m, Index p) {
  return double((n + p) * (n + m));
}

/// Multiply-adds that one row of the regression on the simulated output takes.
double work_of_fit(Index n, Index m, Index p) {
  const double columns = double(n + n * m + m + 2);
  return double(p) * (double(n * n * (m + 1)) + columns * columns / 2);
}

/// Best first by the rule of the header.
void rank(std::vector<ScoredRecipe>& recipes) {
  double best = std::numeric_limits<double>::infinity();
  for (const ScoredRecipe& candidate : recipes) best = std::min(best, candidate.error);
  const auto key = [best](const ScoredRecipe& candidate) {
    const bool equal = candidate.error <= std::max(equal_errors * best, no_error);
    return std::tuple(!equal, equal ? candidate.recipe.order : 0, candidate.error);
  };
  std::stable_sort(recipes.begin(), recipes.end(),
                   [&key](const auto& a, const auto& b) { return key(a) < key(b); });
}

class Search {
 public:
  Search(const SearchData& data, const SearchSpace& space, const ForEach& for_each,
         SearchEffort& effort)
      : data_(data), space_(space), for_each_(for_each), effort_(effort) {
    for (std::size_t i = 0; i < folds; ++i) fold_sums_[i] = sums_of(data.folds[i].fit);
  }

  std::vector<ScoredRecipe> run();

 private:
  static constexpr std::size_t folds = 2;
  /// Extended observability matrices of one fold and horizon, one for each weighting.
  using Gammas = std::vector<Matrix>;

  StretchSums sums_of(RowRange fit) const;
  const Gammas& gammas(std::size_t fold, int horizon) const;
  Dynamics dynamics(const Recipe& recipe, std::size_t fold) const;
  Index rows_of_first_stage() const;
  /// Scores every recipe of the space with B and D from the compression.
  std::vector<ScoredRecipe> compressed_stage();
  void score_compressed(std::size_t fold, std::size_t horizon, std::vector<double>& errors);
  /// The recipe of a place in the table of the first stage.
  Recipe recipe_at(std::size_t place) const;
  std::vector<ScoredRecipe> simulated_stage(const std::vector<ScoredRecipe>& found);
  std::vector<ScoredRecipe> refined_stage(const std::vector<ScoredRecipe>& simulated);
  std::vector<ScoredRecipe> score_regressed(std::vector<Recipe> recipes);
  double work_of_regression(const Recipe& recipe) const;
  std::size_t affordable(const Recipe& recipe, double least, double most) const;

  std::size_t orders() const {
    return static_cast<std::size_t>(space_.max_order - space_.min_order + 1);
  }
  std::size_t places_of_horizon() const { return space_.weightings.size() * orders(); }

  const SearchData& data_;
  const SearchSpace& space_;
  const ForEach& for_each_;
  SearchEffort& effort_;
  std::array<StretchSums, folds> fold_sums_;
  std::array<std::vector<Gammas>, folds> gammas_;  // by fold and horizon
};

StretchSums Search::sums_of(RowRange fit) const {
  // The edges of the folds cut the rows into three stretches; a fold fits whole ones.
  const Index rows = data_.normalised.rows();
  const std::array<Index, 4> edges{0, std::min(data_.folds[0].fit.end, data_.folds[1].fit.begin),
                                   std::max(data_.folds[0].fit.end, data_.folds[1].fit.begin),
                                   rows};
  StretchSums sums;
  for (std::size_t i = 0; i < data_.sums.size(); ++i)
    if (edges[i] >= fit.begin && edges[i + 1] <= fit.end) sums.append(data_.sums[i]);
  return sums;
}

const Search::Gammas& Search::gammas(std::size_t fold, int horizon) const {
  const auto at = std::find(space_.horizons.begin(), space_.horizons.end(), horizon);
  return gammas_[fold][static_cast<std::size_t>(at - space_.horizons.begin())];
}

Dynamics Search::dynamics(const Recipe& recipe, std::size_t fold) const {
  const auto at = std::find(space_.weightings.begin(), space_.weightings.end(), recipe.weighting);
  const Matrix& gamma =
      gammas(fold, recipe.horizon)[static_cast<std::size_t>(at - space_.weightings.begin())];
  return shift_invariant(gamma, data_.normalised.y.cols(), recipe.order, recipe.stability);
}

Recipe Search::recipe_at(std::size_t place) const {
  const std::size_t in_horizon = place % places_of_horizon();
  Recipe recipe;
  recipe.horizon = space_.horizons[place / places_of_horizon()];
  recipe.weighting = space_.weightings[in_horizon / orders()];
  recipe.order = space_.min_order + static_cast<int>(in_horizon % orders());
  recipe.stability = space_.stability;
  recipe.direct = space_.direct.front();
  return recipe;
}

Index Search::rows_of_first_stage() const {
  const Index m = data_.normalised.u.cols(), p = data_.normalised.y.cols();
  double one_row = 0;
  for (int n = space_.min_order; n <= space_.max_order; ++n) one_row += work_of_run(n, m, p);
  one_row *= double(folds * space_.horizons.size() * space_.weightings.size());
  // A third of the budget is this stage's.
  return std::max(least_scored, static_cast<Index>(effort_.budget / 3 / one_row));
}

void Search::score_compressed(std::size_t fold_index, std::size_t horizon_index,
                              std::vector<double>& errors) {
  const Fold& fold = data_.folds[fold_index];
  const Record& record = data_.normalised;
  const int horizon = space_.horizons[horizon_index];
  const Projection projection(compress(fold_sums_[fold_index], data_.normalisation, record,
                                       segments_within(record, fold.fit), horizon));
  const Normalisation fitted =
      normalisation_of(fold_sums_[fold_index], data_.normalisation.u_mean.size());
  const RowRange scored = nearest(fold, rows_of_first_stage());
  Gammas& own = gammas_[fold_index][horizon_index];
  for (std::size_t w = 0; w < space_.weightings.size(); ++w) {
    own.push_back(projection.observability(space_.weightings[w]).gamma);
    for (std::size_t i = 0; i < orders(); ++i) {
      const std::size_t place = horizon_index * places_of_horizon() + w * orders() + i;
      const Recipe recipe = recipe_at(place);
      if (recipe.order > own.back().cols() - record.y.cols()) break;
      const Dynamics found =
          shift_invariant(own.back(), record.y.cols(), recipe.order, recipe.stability);
      if (!is_stable(found.A)) continue;
      StateSpaceModel model =
          projection.with_response(found.A, found.C, recipe.direct, record.period_s);
      set_operating_point(model, data_.normalisation, fitted);
      const double error = rms(held_out_errors(model, record, fold, scored));
      if (std::isfinite(error)) errors[place] = error;
    }
  }
}

std::vector<ScoredRecipe> Search::compressed_stage() {
  const std::size_t places = space_.horizons.size() * places_of_horizon();
  std::array<std::vector<double>, folds> errors;
  for (std::size_t i = 0; i < folds; ++i) {
    errors[i].assign(places, std::numeric_limits<double>::infinity());
    gammas_[i].assign(space_.horizons.size(), {});
  }
  for_each_(folds * space_.horizons.size(), [&](std::size_t task) {
    const std::size_t fold = task % folds;
    score_compressed(fold, task / folds, errors[fold]);
  });
  std::vector<ScoredRecipe> found;
  for (std::size_t place = 0; place < places; ++place) {
    const double error = (errors[0][place] + errors[1][place]) / double(folds);
    if (!std::isfinite(error)) continue;
    const Recipe recipe = recipe_at(place);
    for (const Fold& fold : data_.folds)
      effort_.spent +=
          work_of_run(recipe.order, data_.normalised.u.cols(), data_.normalised.y.cols()) *
          double(nearest(fold, rows_of_first_stage()).size());
    found.push_back({recipe, error});
  }
  rank(found);
  return found;
}

std::vector<ScoredRecipe> Search::score_regressed(std::vector<Recipe> recipes) {
  std::vector<std::array<FoldErrors, folds>> errors(recipes.size());
  for_each_(folds * recipes.size(), [&](std::size_t task) {
    const Recipe& recipe = recipes[task / folds];
    const std::size_t i = task % folds;
    const Fold& fold = data_.folds[i];
    const Dynamics found = dynamics(recipe, i);
    if (!is_stable(found.A)) return;
    const Response response =
        recipe.refinement_steps > 0
            ? refine_response(found.A, found.C, recipe.direct, data_.normalised, fold.fit,
                              recipe.refinement_steps)
            : fit_response(found.A, found.C, recipe.direct, data_.normalised, fold.fit,
                           Accuracy::fast);
    errors[task / folds][i] = errors_of(response, data_.normalised, fold);
  });
  std::vector<ScoredRecipe> scored;
  for (std::size_t i = 0; i < recipes.size(); ++i) {
    const double whole = (errors[i][0].whole + errors[i][1].whole) / double(folds);
    const double recent = (errors[i][0].recent + errors[i][1].recent) / double(folds);
    if (!std::isfinite(whole)) continue;
    const bool shifted = recent < worthwhile_recency * whole;
    recipes[i].operating_point = shifted ? OperatingPoint::recent : OperatingPoint::whole;
    scored.push_back({recipes[i], shifted ? recent : whole});
    effort_.spent += work_of_regression(recipes[i]);
  }
  rank(scored);
  return scored;
}

double Search::work_of_regression(const Recipe& recipe) const {
  const Index rows = data_.folds[0].fit.size() + data_.folds[1].fit.size();
  // A step of the refinement walks the rows twice, once with more columns.
  return work_of_fit(recipe.order, data_.normalised.u.cols(), data_.normalised.y.cols()) *
         double(rows) * double(1 + 3 * recipe.refinement_steps);
}

std::size_t Search::affordable(const Recipe& recipe, double least, double most) const {
  return static_cast<std::size_t>(
      std::clamp(effort_.budget / 3 / work_of_regression(recipe), least, most));
}

std::vector<ScoredRecipe> Search::simulated_stage(const std::vector<ScoredRecipe>& found) {
  if (found.empty()) return {};
  std::vector<Recipe> recipes;
  const std::size_t count =
      std::min(found.size(), affordable(found.front().recipe, least_simulated, most_simulated));
  for (std::size_t i = 0; i < count; ++i) {
    recipes.push_back(found[i].recipe);
    recipes.back().fit = ResponseFit::simulation;
  }
  std::vector<ScoredRecipe> scored = score_regressed(std::move(recipes));
  if (scored.empty() || space_.direct.size() == 1) return scored;
  Recipe other = scored.front().recipe;
  other.direct = !other.direct;
  const std::vector<ScoredRecipe> without = score_regressed({other});
  scored.insert(scored.end(), without.begin(), without.end());
  rank(scored);
  return scored;
}

std::vector<ScoredRecipe> Search::refined_stage(const std::vector<ScoredRecipe>& simulated) {
  if (simulated.empty() || simulated.front().error <= no_error) return {};
  std::vector<Recipe> recipes;
  Recipe refined = simulated.front().recipe;
  refined.refinement_steps = refinement_steps;
  const std::size_t count =
      std::min(simulated.size(), affordable(refined, least_refined, most_refined));
  for (std::size_t i = 0; i < count; ++i) {
    recipes.push_back(simulated[i].recipe);
    recipes.back().refinement_steps = refinement_steps;
  }
  return score_regressed(std::move(recipes));
}

std::vector<ScoredRecipe> Search::run() {
  const std::vector<ScoredRecipe> compressed = compressed_stage();
  const std::vector<ScoredRecipe> simulated = simulated_stage(compressed);
  const std::vector<ScoredRecipe> refined = refined_stage(simulated);
  // The simulated output decides unless another stage is clearly better.
  std::vector<ScoredRecipe> all = simulated;
  const auto enter = [&all](const std::vector<ScoredRecipe>& stage) {
    const bool better =
        !stage.empty() && (all.empty() || stage.front().error < worthwhile * all.front().error);
    all.insert(better ? all.begin() : all.end(), stage.begin(), stage.end());
  };
  enter(compressed);
  enter(refined);
  return all;
}

}  // namespace

std::array<Fold, 2> folds_of(Index rows, double tune_share) {
  const Index tune = std::clamp<Index>(std::lround(double(rows) * tune_share), 1, rows - 1);
  return {Fold{{0, rows - tune}, {rows - tune, rows}}, Fold{{tune, rows}, {0, tune}}};
}

std::vector<ScoredRecipe> ranked_recipes(const SearchData& data, const SearchSpace& space,
                                         const ForEach& for_each, SearchEffort& effort) {
  return Search(data, space, for_each, effort).run();
}

double held_out_error_of_constant(const Record& normalised, const std::array<Fold, 2>& folds) {
  double sum = 0;
  for (const Fold& fold : folds) {
    const Eigen::RowVectorXd mean =
        normalised.y.middleRows(fold.fit.begin, fold.fit.size()).colwise().mean();
    sum += rms(normalised.y.middleRows(fold.tune.begin, fold.tune.size()).rowwise() - mean);
  }
  return sum / double(folds.size());
}

Vector recent_operating_point(const Matrix& residuals, bool towards_end) {
  const Index half = (residuals.rows() + 1) / 2;
  const auto nearest = residuals.middleRows(towards_end ? residuals.rows() - half : 0, half);
  return nearest.colwise().mean().transpose();
}

HankelFactor compress(const StretchSums& sums, const Normalisation& normalisation,
                      const Record& normalised, const std::vector<Segment>& segments,
                      Index horizon) {
  if (auto factor = factor_of_sums(sums, normalisation, horizon)) return std::move(*factor);
  return factor_of_rows(normalised, segments, horizon);
}

}  // namespace reident::identification
