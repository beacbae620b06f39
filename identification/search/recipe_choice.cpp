#include "identification/search/recipe_choice.hpp"

#include <optional>
#include <utility>

#include "identification/search/horizons.hpp"
#include "identification/subspace/excitation.hpp"
#include "identification/subspace/projection.hpp"

namespace reident::identification {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// |ln| of an eigenvalue times the rows: less than a period of an oscillation looks like a drift.
constexpr double slow_phase = 6.283;
constexpr const char* of_a_controller =
    "; where a controller keeps it there, take the controller's reference as the input";

/// The only recipe there is, where the options leave no choice or the rows do not allow one.
std::optional<Recipe> given_recipe(const HankelSupply& supply, Index fitted_rows,
                                   const IdentifyOptions& options) {
  if (!options.order || !options.horizon) return std::nullopt;
  const bool chosen = options.weighting && options.direct_feedthrough && options.response_fit;
  if (!chosen && supply.columns(*options.horizon) > 0) return std::nullopt;
  if (supply.columns({0, fitted_rows}, *options.horizon) == 0) return std::nullopt;
  Recipe recipe;
  recipe.order = *options.order;
  recipe.horizon = *options.horizon;
  recipe.weighting = options.weighting.value_or(Weighting::n4sid);
  recipe.direct = options.direct_feedthrough.value_or(true);
  recipe.fit = options.response_fit.value_or(ResponseFit::simulation);
  return recipe;
}

/// Lowers the largest order to what the inputs excite: an order of n needs n + 1 block rows.
std::optional<Verdict> limit_by_excitation(PreparedRows& rows, SearchSpace& space,
                                           std::vector<std::string>& warnings) {
  if (rows.inputs() == 0) return std::nullopt;
  const int horizon = space.horizons.back();
  const Excitation excitation = excitation_of(Projection(rows.factor(horizon)).input_innovations());
  if (excitation.order >= horizon) return std::nullopt;
  const std::string strongest = rows.input_name(
      rows.normalisation().inputs[static_cast<std::size_t>(excitation.strongest_input)]);
  const int highest = static_cast<int>(excitation.order) - 1;
  if (highest < space.min_order)
    return Verdict{VerdictCode::insufficient_excitation,
                   strongest + " follows from its own past and the other inputs after " +
                       std::to_string(excitation.order) + " samples, but order " +
                       std::to_string(space.min_order) + " needs " +
                       std::to_string(space.min_order + 1) +
                       "; choose a window in which it moves more freely"};
  if (highest < space.max_order) {
    space.max_order = highest;
    warnings.push_back(strongest + " excites no order above " + std::to_string(highest));
  }
  return std::nullopt;
}

/// Lowers the largest order to what the longest horizon carries that the rows feed.
void limit_by_rows(const PreparedRows& rows, SearchSpace& space,
                   std::vector<std::string>& warnings) {
  const int largest = largest_order(space.horizons.back(), rows.outputs());
  if (rows.options().horizon || largest >= space.max_order) return;
  const int usual = horizon_of_order(space.max_order, rows.outputs());
  if (usual > space.horizons.back())
    warnings.push_back("the rows feed no order above " + std::to_string(largest) +
                       "; those up to " + std::to_string(space.max_order) + " take " +
                       std::to_string(rows.rows_needed(usual, rows.inputs() + rows.outputs())) +
                       " rows to identify from, without a gap");
  space.max_order = largest;
}

/// Judges the best recipe by `constant`, the error of the mean on rows held out. Sets
/// acceptable_error.
std::optional<Verdict> useless(RecipeChoice& choice, double constant, bool may_enforce_stability) {
  const std::vector<ScoredRecipe>& ranked = choice.ranked;
  const bool unstable = ranked.empty() || ranked.front().recipe.stability == Stability::enforced;
  // A system that really is unstable must not pass as a stable one that follows it a little.
  // The best of many candidates beats the mean by a little even on noise.
  choice.acceptable_error = (unstable ? 0.5 : 0.98) * constant;
  if (!ranked.empty() && ranked.front().error < choice.acceptable_error) return std::nullopt;
  if (unstable && !may_enforce_stability)
    return Verdict{
        VerdictCode::unstable,
        std::string("every model asked for is unstable; choose a window in which the equipment "
                    "stays in its range, or let A be made stable") +
            of_a_controller};
  if (unstable)
    return Verdict{VerdictCode::unstable,
                   std::string("every model asked for is unstable, and made stable errs more than "
                               "half as much as the mean; choose a window in which the equipment "
                               "stays in its range") +
                       of_a_controller};
  return Verdict{VerdictCode::no_better_than_mean,
                 "on rows held out the best model errs by " + four_digits(ranked.front().error) +
                     " standard deviations and the mean by " + four_digits(constant) +
                     "; the inputs do not explain the outputs in this window"};
}

/// What the options leave open.
SearchSpace search_space(const PreparedRows& rows, const HankelSupply& supply) {
  const IdentifyOptions& options = rows.options();
  SearchSpace space{feasible_horizons(supply, options),
                    {Weighting::n4sid, Weighting::moesp, Weighting::cva},
                    options.order.value_or(options.min_order),
                    options.order.value_or(options.max_order),
                    {true, false},
                    {ResponseFit::simulation, ResponseFit::subspace}};
  if (options.weighting) space.weightings = {*options.weighting};
  if (options.direct_feedthrough) space.direct = {*options.direct_feedthrough};
  if (options.response_fit) space.fits = {*options.response_fit};
  if (rows.inputs() == 0)
    space.direct = {false};
  else if (!options.order)
    space.least_rate = slow_phase / double(rows.fitted().size());
  return space;
}

RecipeChoice without_choice(const Recipe& given, const IdentifyOptions& options,
                            std::vector<std::string>& warnings) {
  if (!options.weighting)
    warnings.push_back("too few rows to choose on rows held out; the weighting n4sid was taken");
  RecipeChoice choice;
  choice.ranked = {{given, infinity}};
  if (!options.may_enforce_stability) return choice;
  choice.ranked.push_back(choice.ranked.front());
  choice.ranked.back().recipe.stability = Stability::enforced;
  return choice;
}

}  // namespace

std::variant<RecipeChoice, Verdict> choose_recipes(PreparedRows& rows,
                                                   std::vector<std::string>& warnings) {
  const IdentifyOptions& options = rows.options();
  const std::vector<Fold> folds = rows.folds();
  const Index width = rows.inputs() + rows.outputs();
  const HankelSupply supply{rows.segments(), width, folds};
  SearchSpace space = search_space(rows, supply);
  const std::optional<Recipe> given = given_recipe(supply, rows.fitted().size(), options);
  if (given) space.horizons = {given->horizon};
  if (space.horizons.empty()) return rows.too_few_samples(rows.inputs(), rows.outputs());
  if (!given) limit_by_rows(rows, space, warnings);
  if (auto verdict = limit_by_excitation(rows, space, warnings)) return *std::move(verdict);
  if (given) return without_choice(*given, options, warnings);

  SearchEffort effort{options.search_budget, 0};
  std::vector<RangeSums> fold_sums;
  for (const Fold& fold : folds) fold_sums.push_back(rows.sums_of(fold.fit));
  const SearchData data{rows.normalised(), rows.normalisation(), folds, fold_sums};
  const ForEach for_each = options.for_each ? options.for_each : in_sequence;
  RecipeChoice choice;
  choice.ranked = ranked_recipes(data, space, for_each, effort);
  if (choice.ranked.empty() && options.may_enforce_stability) {
    space.stability = Stability::enforced;
    choice.ranked = ranked_recipes(data, space, for_each, effort);
  }
  choice.work_spent = effort.spent;
  const double constant = held_out_error_of_constant(rows.normalised(), folds);
  if (auto verdict = useless(choice, constant, options.may_enforce_stability))
    return *std::move(verdict);
  return choice;
}

}  // namespace reident::identification
