#include "identification/choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "identification/hankel.hpp"
#include "identification/response.hpp"
#include "identification/subspace.hpp"

namespace reident::identification {
namespace {

constexpr double equal_errors = 1.01;
constexpr double no_error = 1e-6;  // of an output's deviation
constexpr double worthwhile_recency = 0.95;
constexpr double worthwhile_refinement = 0.99;
constexpr int refinement_steps = 10;

/// Mean over outputs of the root mean square over rows.
double rms(const Matrix& errors) {
  return errors.colwise().norm().mean() / std::sqrt(double(errors.rows()));
}

/// Errors of one candidate on held-out rows, with both operating points.
struct FoldErrors {
  double whole = 0;
  double recent = 0;
};

std::optional<FoldErrors> fold_errors(const Dynamics& dynamics, int steps, const Record& record,
                                      const Fold& fold) {
  if (!is_stable(dynamics.A)) return std::nullopt;
  const Response response =
      steps > 0 ? refine_response(dynamics.A, dynamics.C, record, fold.fit, steps)
                : fit_response(dynamics.A, dynamics.C, record, fold.fit, Accuracy::fast);
  const bool forwards = fold.fit.begin < fold.tune.begin;
  // Forwards the state is carried on; backwards the run starts anew from its first outputs.
  const RowRange run{fold.fit.begin, forwards ? fold.tune.end : fold.fit.end};
  const Matrix y_hat = free_run(response.model, record, run, response.x0);
  const Matrix residuals =
      record.y.middleRows(fold.fit.begin, fold.fit.size()) - y_hat.topRows(fold.fit.size());
  const Matrix errors = record.y.middleRows(fold.tune.begin, fold.tune.size()) -
                        (forwards ? Matrix(y_hat.bottomRows(fold.tune.size()))
                                  : free_run(response.model, record, fold.tune));
  const Vector shift = recent_operating_point(residuals, forwards);
  const FoldErrors result{rms(errors), rms(errors.rowwise() - shift.transpose())};
  if (!std::isfinite(result.whole)) return std::nullopt;
  return result;
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

/// The compressed folds, and what a recipe makes of them.
class Search {
 public:
  Search(const Record& normalised, const std::array<Fold, 2>& folds, Index longest_horizon)
      : record_(normalised),
        folds_(folds),
        factors_{compress(normalised, folds[0].fit, 2 * longest_horizon),
                 compress(normalised, folds[1].fit, 2 * longest_horizon)} {}

  /// Errors of all orders of the space at one horizon and weighting, in the order of orders.
  void score(const SearchSpace& space, int horizon, std::vector<ScoredRecipe>& found) const {
    const Index p = record_.y.cols();
    const std::array<Projection, 2> projections{Projection(factors_[0], horizon),
                                                Projection(factors_[1], horizon)};
    const int limit = std::min(space.max_order, (horizon - 1) * static_cast<int>(p));
    for (const Weighting weighting : space.weightings) {
      const std::array<Matrix, 2> gammas{projections[0].observability(weighting).gamma,
                                         projections[1].observability(weighting).gamma};
      for (int order = space.min_order; order <= limit; ++order) {
        const Recipe recipe{order, horizon, weighting, space.stability, {}, space.refinement_steps};
        if (const auto scored = scored_recipe(recipe, gammas)) found.push_back(*scored);
      }
    }
  }

 private:
  std::optional<ScoredRecipe> scored_recipe(Recipe recipe,
                                            const std::array<Matrix, 2>& gammas) const {
    FoldErrors sum;
    for (std::size_t i = 0; i < folds_.size(); ++i) {
      const Dynamics dynamics =
          shift_invariant(gammas[i], record_.y.cols(), recipe.order, recipe.stability);
      const auto errors = fold_errors(dynamics, recipe.refinement_steps, record_, folds_[i]);
      if (!errors) return std::nullopt;
      sum.whole += errors->whole;
      sum.recent += errors->recent;
    }
    const bool recent = sum.recent < worthwhile_recency * sum.whole;
    recipe.operating_point = recent ? OperatingPoint::recent : OperatingPoint::whole;
    return ScoredRecipe{recipe, (recent ? sum.recent : sum.whole) / double(folds_.size())};
  }

  const Record& record_;
  const std::array<Fold, 2>& folds_;
  std::array<HankelFactor, 2> factors_;
};

/// The space that holds one recipe alone, refined.
SearchSpace refinement_of(const Recipe& recipe) {
  return {{recipe.horizon}, {recipe.weighting}, recipe.order,
          recipe.order,     recipe.stability,   refinement_steps};
}

}  // namespace

std::array<Fold, 2> folds_of(Index rows, double tune_share) {
  const Index tune = std::clamp<Index>(std::lround(double(rows) * tune_share), 1, rows - 1);
  return {Fold{{0, rows - tune}, {rows - tune, rows}}, Fold{{tune, rows}, {0, tune}}};
}

std::vector<ScoredRecipe> ranked_recipes(const Record& normalised, const std::array<Fold, 2>& folds,
                                         const SearchSpace& space) {
  const Search search(normalised, folds, space.horizons.back());
  std::vector<ScoredRecipe> found;
  for (const int horizon : space.horizons) search.score(space, horizon, found);
  rank(found);
  if (found.empty() || found.front().error <= no_error) return found;

  std::vector<ScoredRecipe> refined;
  search.score(refinement_of(found.front().recipe), found.front().recipe.horizon, refined);
  if (!refined.empty() && refined.front().error < worthwhile_refinement * found.front().error)
    found.insert(found.begin(), refined.front());
  return found;
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

}  // namespace reident::identification
