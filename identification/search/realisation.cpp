#include "identification/search/realisation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "identification/search/mode_elimination.hpp"
#include "identification/search/model_search.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/subspace/input_response.hpp"
#include "identification/subspace/kalman.hpp"
#include "identification/subspace/noise_covariance.hpp"
#include "identification/subspace/projection.hpp"

namespace reident::identification {
namespace {

/// B, D and y0 on the way that the recipe says, and the refinement.
StateSpaceModel respond(PreparedRows& rows, const Recipe& recipe, const Projection& projection,
                        const Dynamics& dynamics) {
  auto [A, C] = dynamics;
  const auto last = [fitted = rows.fitted().size()](Index count) {
    return RowRange{std::max<Index>(0, fitted - count), fitted};
  };
  std::vector<ErrorColour> colours;
  if (recipe.refinement_steps > 0) {
    const RowRange refined_rows = last(recipe.refined_rows);
    Response response = refined({A, C}, recipe, rows.normalised(), refined_rows);
    if (recipe.weighted) colours = deviations_of(response, rows.normalised(), refined_rows);
    A = std::move(response.model.A);
    C = std::move(response.model.C);
  }
  if (recipe.fit == ResponseFit::subspace)
    return with_response(projection, A, C, recipe.direct, rows.record().period_s);
  // All rows but in the longest windows.
  Recipe unrefined = recipe;
  unrefined.refinement_steps = 0;
  const Index affordable =
      affordable_rows(unrefined, rows.inputs(), rows.outputs(), rows.options().search_budget / 3);
  return fit_response(A, C, recipe.direct, rows.normalised(), last(affordable), Accuracy::exact,
                      colours)
      .model;
}

/// Where the refinement has driven a mode to the least rate: there it stands for what is slower.
bool has_mode_at_the_limit(const Matrix& A, double least_rate) {
  constexpr double near = 1.01;
  const ComplexVector modes = eigenvalues(A);
  return std::any_of(modes.begin(), modes.end(), [least_rate](const std::complex<double>& mode) {
    return std::abs(std::log(mode)) < near * least_rate;
  });
}

}  // namespace

std::optional<Identified> realise(PreparedRows& rows, const Recipe& recipe,
                                  double longest_time_constant_s) {
  const HankelFactor& hankel = rows.factor(recipe.horizon);
  const Projection projection(hankel);
  auto [gamma, singular_values] = projection.observability(recipe.weighting);
  const Index fitted = rows.fitted().size();
  const auto dynamics = shift_invariant_within({fitted, recipe.least_rate}, gamma, hankel.outputs,
                                               recipe.subspace_order(), recipe.stability);
  if (!dynamics) return std::nullopt;
  if (recipe.refinement_steps == 0 &&
      slowest_time_constant_s(dynamics->A, rows.record().period_s) > longest_time_constant_s)
    return std::nullopt;
  const Index m = rows.record().u.cols();
  StateSpaceModel model = respond(rows, recipe, projection, *dynamics);
  if (model.order() != recipe.order) return std::nullopt;
  Identified result;
  if (recipe.stability == Stability::enforced)
    result.warnings.push_back(
        "every model asked for was unstable; A was taken so that it is stable, at some bias");
  if (recipe.order == 0)
    model.K = Matrix(0, rows.outputs());
  else if (const auto K = kalman_gain(model.A, model.C, noise_covariance(projection, model)))
    model.K = *K;
  else
    result.warnings.push_back(
        "the model has no Kalman gain: its Riccati equation has no checked solution");
  if (has_mode_at_the_limit(model.A, recipe.least_rate))
    result.warnings.push_back(
        "a mode is as slow as these rows can show: it stands for a drift of the outputs, and what "
        "an input does through it is uncertain; choose a longer window, or add the telemetry of "
        "what drives the drift");
  if (recipe.operating_point == OperatingPoint::recent)
    model.y0 += recent_operating_point(
        rows.normalised().y.topRows(fitted) - free_run(model, rows.normalised(), {0, fitted}),
        true);
  result.model = in_units(model, rows.normalisation());
  if (!is_well_formed(result.model)) return std::nullopt;
  result.recipe = recipe;
  result.spectral_radius = spectral_radius(result.model);
  result.singular_values = std::move(singular_values);
  result.hankel_condition = hankel.least_share;
  result.input_min = rows.sums().least().head(m);
  result.input_max = rows.sums().greatest().head(m);
  result.x0 = estimate_initial_state(result.model, rows.record(),
                                     segments_within(rows.record(), rows.fitted()), state_rows);
  if (!result.x0.allFinite()) return std::nullopt;
  return result;
}

}  // namespace reident::identification
