#include "identification/choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/hankel.hpp"
#include "identification/response.hpp"
#include "identification/subspace.hpp"

namespace reident::identification {
namespace {

constexpr double equal_errors = 1.01;

/// Error of the response fitted on `fit`, run on through `tune` and scored there; +inf for an
/// unstable model.
double tuning_error(const AC& ac, const Record& record, RowRange fit, RowRange tune) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!ac.A.allFinite() || !(spectral_radius({ac.A, {}, {}, {}, {}, {}, {}, 1}) < 1))
    return infinity;
  const Response response = fit_response(ac.A, ac.C, record, fit, Accuracy::fast);
  const Matrix y_hat = free_run(response.model, record, {fit.begin, tune.end}, response.x0);
  const Matrix error = record.y.middleRows(tune.begin, tune.size()) - y_hat.bottomRows(tune.size());
  const double result = error.colwise().norm().mean() / std::sqrt(double(tune.size()));
  return std::isfinite(result) ? result : infinity;
}

}  // namespace

std::vector<ScoredRecipe> ranked_recipes(const Record& normalised, RowRange fit, RowRange tune,
                                         const SearchSpace& space) {
  const HankelFactor factor = compress(normalised, fit, 2 * space.horizons.back());
  std::vector<ScoredRecipe> found;
  for (const int horizon : space.horizons) {
    const Projection projection(factor, horizon);
    for (const Weighting weighting : space.weightings) {
      const auto [gamma, singular_values] = projection.observability(weighting);
      const int limit = std::min(space.max_order, (horizon - 1) * int(factor.outputs));
      for (int order = space.min_order; order <= limit; ++order) {
        const double error =
            tuning_error(shift_invariant(gamma, factor.outputs, order), normalised, fit, tune);
        if (std::isfinite(error)) found.push_back({{order, horizon, weighting}, error});
      }
    }
  }
  if (found.empty()) return found;
  const double best =
      std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return a.error < b.error;
      })->error;
  std::stable_sort(found.begin(), found.end(), [best](const auto& a, const auto& b) {
    const bool a_equals = a.error <= equal_errors * best, b_equals = b.error <= equal_errors * best;
    if (a_equals != b_equals) return a_equals;
    if (a_equals && a.recipe.order != b.recipe.order) return a.recipe.order < b.recipe.order;
    return a.error < b.error;
  });
  return found;
}

}  // namespace reident::identification
