#include "identification/search/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "identification/fit/output_error_fit.hpp"
#include "identification/search/finite_check.hpp"
#include "identification/search/horizons.hpp"
#include "identification/search/model_search.hpp"
#include "identification/subspace/excitation.hpp"
#include "identification/subspace/hankel.hpp"
#include "identification/subspace/kalman.hpp"
#include "identification/subspace/normalise.hpp"
#include "identification/subspace/subspace.hpp"

namespace reident::identification {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// One call of identify(): the steps in their order, each of which may end it with a verdict.
class Identification {
 public:
  Identification(const Record& record, RowRange rows, const IdentifyOptions& options, LagSums& sums,
                 bool keep)
      : record_(record),
        rows_{rows.begin, rows.end - options.tune_rows},
        tune_{rows.end - options.tune_rows, rows.end},
        options_(options),
        lag_sums_(sums),
        keep_(keep) {}

  IdentifyResult run();

 private:
  void phase(std::string_view name) const;
  /// Checks the samples, sums them and leaves out the channels that say nothing.
  std::optional<Verdict> prepare();
  StretchSums sums_of(RowRange rows);
  void warn_of_constants(const std::vector<Index>& moving, Index channels, const char* kind);
  void leave_out_redundant_inputs();
  std::string input_name(Index input) const {
    return channel_name("input", input, options_.input_names);
  }
  /// Ranks what can be identified, best first.
  std::optional<Verdict> choose(std::vector<ScoredRecipe>& ranked);
  /// The only recipe there is, where the options leave no choice or the rows do not allow one.
  std::optional<Recipe> given_recipe(const HankelSupply& supply) const;
  Verdict too_few_samples(Index width, bool held_out) const;
  /// `constant` is the error of the mean on rows held out; sets acceptable_error_.
  std::optional<Verdict> useless(const std::vector<ScoredRecipe>& ranked, double constant);
  /// An order of n needs inputs that excite n + 1 block rows.
  std::optional<Verdict> limit_by_excitation(SearchSpace& space);
  /// Made when first asked for: a model that follows from the sums alone needs no rows.
  const Record& work();
  Index inputs() const { return static_cast<Index>(normalisation_.inputs.size()); }
  Index outputs() const { return static_cast<Index>(normalisation_.outputs.size()); }
  const HankelFactor& factor(int horizon);
  /// The recipe on all rows, absent when it gives no stable model there, or one that is slower.
  std::optional<Identified> realise(const Recipe& recipe, double longest_time_constant_s);
  /// B, D and y0 on the way that the recipe says, and the refinement.
  StateSpaceModel respond(const Recipe& recipe, const Projection& projection,
                          const Dynamics& dynamics);
  /// What is said of the model besides its matrices.
  void describe(Identified& result) const;

  std::vector<Fold> folds() const;

  const Record& record_;
  RowRange rows_;  // that are fitted
  RowRange tune_;  // behind them; empty: some of the fitted rows are held out in turn
  const IdentifyOptions& options_;
  LagSums& lag_sums_;
  bool keep_;
  StretchSums all_sums_;
  Normalisation normalisation_;
  std::vector<Segment> segments_;        // of the rows, counted from the first
  std::optional<Record> work_;           // both rows, normalised, without the channels left out
  std::map<int, HankelFactor> factors_;  // of all rows, by the horizon
  std::vector<std::string> warnings_;
  double work_spent_ = 0;
  double acceptable_error_ = infinity;  // on rows held out; a larger one is useless
};

IdentifyResult Identification::run() {
  phase("prepare");
  if (auto verdict = prepare()) return *verdict;
  phase("choose");
  std::vector<ScoredRecipe> ranked;
  if (auto verdict = choose(ranked)) return *verdict;
  std::optional<Identified> best;
  for (const ScoredRecipe& candidate : ranked) {
    phase("identify");
    // A model that does not explain the outputs takes no other one's place.
    if (best && !(candidate.error < acceptable_error_)) break;
    const double longest = options_.longest_time_constant_s;
    auto identified = realise(candidate.recipe, best ? longest : infinity);
    if (!identified) continue;
    const double slowest = slowest_time_constant_s(identified->model);
    if (best && slowest > longest) continue;
    if (std::isfinite(candidate.error)) identified->held_out_error = candidate.error;
    if (best)
      identified->warnings.push_back(
          "of the models with smaller errors on rows held out each has a mode that is slower "
          "than " +
          four_digits(longest) + " s");
    best = std::move(identified);
    if (slowest <= longest) break;
  }
  if (best) return std::move(*best);
  return Verdict{VerdictCode::unstable,
                 "no choice that was stable on part of the rows is stable on all of them; choose "
                 "a longer window"};
}

void Identification::phase(std::string_view name) const {
  if (options_.on_phase) options_.on_phase(name);
}

std::optional<Verdict> Identification::prepare() {
  if (rows_.size() < 4) return too_few_samples(record_.u.cols() + record_.y.cols(), true);
  segments_ = segments_from(record_, rows_);
  all_sums_ = sums_of(rows_);
  if (!all_finite(all_sums_))
    if (auto verdict = non_finite_values(record_, rows_, options_)) return verdict;
  normalisation_ = normalisation_of(all_sums_, record_.u.cols());
  warn_of_constants(normalisation_.inputs, record_.u.cols(), "input");
  warn_of_constants(normalisation_.outputs, record_.y.cols(), "output");
  if (normalisation_.outputs.empty())
    return Verdict{VerdictCode::constant_outputs,
                   "no output moves in the rows to identify from; choose a window in which the "
                   "equipment does something"};
  if (normalisation_.inputs.empty() && record_.u.cols() > 0)
    return Verdict{VerdictCode::constant_inputs,
                   "no input moves in the rows to identify from; choose a window in which the "
                   "equipment is driven"};
  leave_out_redundant_inputs();
  return std::nullopt;
}

StretchSums Identification::sums_of(RowRange rows) {
  const std::vector<Segment> parts = segments_within(record_, rows);
  if (parts.empty()) return {};
  const TickRange ticks{parts.front().first_tick, parts.back().first_tick + parts.back().size()};
  return keep_ ? lag_sums_.keep_over(ticks, record_) : lag_sums_.over(ticks, record_);
}

void Identification::warn_of_constants(const std::vector<Index>& moving, Index channels,
                                       const char* kind) {
  for (Index c = 0; c < channels; ++c)
    if (!std::binary_search(moving.begin(), moving.end(), c))
      warnings_.push_back(
          channel_name(kind, c, kind[0] == 'i' ? options_.input_names : options_.output_names) +
          " is constant in the rows to identify from: the "
          "model does not say how " +
          (kind[0] == 'i' ? "it acts" : "it moves"));
}

void Identification::leave_out_redundant_inputs() {
  if (are_independent(input_correlation(all_sums_, normalisation_))) return;
  const std::vector<RedundantInput> redundant = redundant_inputs(work().u.topRows(rows_.size()));
  if (redundant.empty()) return;
  std::vector<Index>& inputs = normalisation_.inputs;
  const std::vector<Index> before = inputs;
  for (auto found = redundant.rbegin(); found != redundant.rend(); ++found) {
    std::string others;
    for (const Index other : found->explained_by)
      others += (others.empty() ? "" : ", ") + input_name(before[static_cast<std::size_t>(other)]);
    warnings_.push_back(input_name(before[static_cast<std::size_t>(found->input)]) +
                        " is a linear combination of " + others +
                        " at every row and is left out of the model");
    inputs.erase(inputs.begin() + found->input);
  }
  work_.reset();
}

std::optional<Recipe> Identification::given_recipe(const HankelSupply& supply) const {
  if (!options_.order || !options_.horizon) return std::nullopt;
  const bool chosen = options_.weighting && options_.direct_feedthrough && options_.response_fit;
  if (!chosen && supply.columns(*options_.horizon) > 0) return std::nullopt;
  if (supply.columns({0, rows_.size()}, *options_.horizon) == 0) return std::nullopt;
  Recipe recipe;
  recipe.order = *options_.order;
  recipe.horizon = *options_.horizon;
  recipe.weighting = options_.weighting.value_or(Weighting::n4sid);
  recipe.direct = options_.direct_feedthrough.value_or(true);
  recipe.fit = options_.response_fit.value_or(ResponseFit::simulation);
  return recipe;
}

std::vector<Fold> Identification::folds() const {
  const Index fitted = rows_.size();
  if (tune_.size() == 0) return folds_of(fitted, options_.tune_share);
  return {{{0, fitted}, {fitted, fitted + tune_.size()}}};
}

std::optional<Verdict> Identification::choose(std::vector<ScoredRecipe>& ranked) {
  const std::vector<Fold> folds = this->folds();
  const HankelSupply supply{segments_, inputs() + outputs(), folds};
  SearchSpace space{feasible_horizons(supply, options_),
                    {Weighting::n4sid, Weighting::moesp, Weighting::cva},
                    options_.order.value_or(options_.min_order),
                    options_.order.value_or(options_.max_order),
                    {true, false},
                    {ResponseFit::simulation, ResponseFit::subspace}};
  if (options_.weighting) space.weightings = {*options_.weighting};
  if (options_.direct_feedthrough) space.direct = {*options_.direct_feedthrough};
  if (options_.response_fit) space.fits = {*options_.response_fit};
  if (inputs() == 0) space.direct = {false};
  const std::optional<Recipe> given = given_recipe(supply);
  if (given) space.horizons = {given->horizon};
  if (space.horizons.empty()) return too_few_samples(inputs() + outputs(), true);
  if (auto verdict = limit_by_excitation(space)) return verdict;
  if (given) {
    if (!options_.weighting)
      warnings_.push_back("too few rows to choose on rows held out; the weighting n4sid was taken");
    ranked = {{*given, infinity}};
    if (!options_.may_enforce_stability) return std::nullopt;
    ranked.push_back(ranked.front());
    ranked.back().recipe.stability = Stability::enforced;
    return std::nullopt;
  }
  SearchEffort effort{options_.search_budget, 0};
  std::vector<StretchSums> fold_sums;
  for (const Fold& fold : folds)
    fold_sums.push_back(sums_of({rows_.begin + fold.fit.begin, rows_.begin + fold.fit.end}));
  const SearchData data{work(), normalisation_, folds, fold_sums};
  const ForEach for_each = options_.for_each ? options_.for_each : in_sequence;
  ranked = ranked_recipes(data, space, for_each, effort);
  if (ranked.empty() && options_.may_enforce_stability) {
    space.stability = Stability::enforced;
    ranked = ranked_recipes(data, space, for_each, effort);
  }
  work_spent_ = effort.spent;
  return useless(ranked, held_out_error_of_constant(work(), folds));
}

std::optional<Verdict> Identification::useless(const std::vector<ScoredRecipe>& ranked,
                                               double constant) {
  const bool unstable = ranked.empty() || ranked.front().recipe.stability == Stability::enforced;
  // A system that really is unstable must not pass as a stable one that follows it a little.
  // Of many candidates, the best beats the mean by a little even on noise.
  acceptable_error_ = (unstable ? 0.5 : 0.98) * constant;
  if (!ranked.empty() && ranked.front().error < acceptable_error_) return std::nullopt;
  if (unstable && !options_.may_enforce_stability)
    return Verdict{
        VerdictCode::unstable,
        "every model asked for is unstable; choose a window in which the equipment stays "
        "in its range, or let A be made stable"};
  if (unstable)
    return Verdict{VerdictCode::unstable,
                   "every model asked for is unstable, and made stable errs more than half as much "
                   "as the mean; choose a window in which the equipment stays in its range"};
  return Verdict{VerdictCode::no_better_than_mean,
                 "on rows held out the best model errs by " + four_digits(ranked.front().error) +
                     " standard deviations and the mean by " + four_digits(constant) +
                     "; the inputs do not explain the outputs in this window"};
}

Verdict Identification::too_few_samples(Index width, bool held_out) const {
  const Index s = options_.horizon.value_or(least_horizon(options_));
  const Index fit = 2 * s * width + 2 * s;
  Index needed = fit;
  while (held_out && folds_of(needed, options_.tune_share)[2].fit.size() < fit) ++needed;
  return {VerdictCode::too_few_samples,
          std::to_string(rows_.size()) + " rows in " +
              std::to_string(segments_within(record_, rows_).size()) +
              " segments are too few; at least " + std::to_string(needed) +
              " rows without a gap are needed for a horizon of " + std::to_string(s)};
}

const Record& Identification::work() {
  if (!work_) work_ = normalised(record_, {rows_.begin, tune_.end}, normalisation_);
  return *work_;
}

const HankelFactor& Identification::factor(int horizon) {
  const auto found = factors_.find(horizon);
  if (found != factors_.end()) return found->second;
  auto made = factor_of_sums(all_sums_, normalisation_, horizon);
  if (!made) made = factor_of_rows(work(), segments_, horizon);
  return factors_.emplace(horizon, std::move(*made)).first->second;
}

std::optional<Verdict> Identification::limit_by_excitation(SearchSpace& space) {
  if (inputs() == 0) return std::nullopt;
  const int horizon = space.horizons.back();
  const Excitation excitation = excitation_of(Projection(factor(horizon)).input_innovations());
  if (excitation.order >= horizon) return std::nullopt;
  const std::string weakest =
      input_name(normalisation_.inputs[static_cast<std::size_t>(excitation.weakest_input)]);
  const int highest = static_cast<int>(excitation.order) - 1;
  if (highest < space.min_order)
    return Verdict{VerdictCode::insufficient_excitation,
                   weakest + " follows from its own past and the other inputs after " +
                       std::to_string(excitation.order) + " samples, but order " +
                       std::to_string(space.min_order) + " needs " +
                       std::to_string(space.min_order + 1) +
                       "; choose a window in which it moves more freely"};
  if (highest < space.max_order) {
    space.max_order = highest;
    warnings_.push_back(weakest + " excites no order above " + std::to_string(highest));
  }
  return std::nullopt;
}

StateSpaceModel Identification::respond(const Recipe& recipe, const Projection& projection,
                                        const Dynamics& dynamics) {
  auto [A, C] = dynamics;
  const Index rows = rows_.size();
  const auto last = [rows](Index count) {
    return RowRange{std::max<Index>(0, rows - count), rows};
  };
  if (recipe.refinement_steps > 0) {
    StateSpaceModel refined = refine_response(A, C, recipe.direct, work(),
                                              last(recipe.refined_rows), recipe.refinement_steps)
                                  .model;
    A = std::move(refined.A);
    C = std::move(refined.C);
  }
  if (recipe.fit == ResponseFit::subspace)
    return projection.with_response(A, C, recipe.direct, record_.period_s);
  // All rows but in the longest windows.
  Recipe unrefined = recipe;
  unrefined.refinement_steps = 0;
  const Index affordable =
      affordable_rows(unrefined, inputs(), outputs(), options_.search_budget / 3);
  return fit_response(A, C, recipe.direct, work(), last(affordable), Accuracy::exact).model;
}

std::optional<Identified> Identification::realise(const Recipe& recipe,
                                                  double longest_time_constant_s) {
  const HankelFactor& hankel = factor(recipe.horizon);
  const Projection projection(hankel);
  auto [gamma, singular_values] = projection.observability(recipe.weighting);
  const Dynamics dynamics = shift_invariant(gamma, hankel.outputs, recipe.order, recipe.stability);
  if (!is_stable(dynamics.A)) return std::nullopt;
  if (recipe.refinement_steps == 0 &&
      slowest_time_constant_s(dynamics.A, record_.period_s) > longest_time_constant_s)
    return std::nullopt;
  StateSpaceModel model = respond(recipe, projection, dynamics);
  Identified result;
  result.warnings = warnings_;
  if (recipe.stability == Stability::enforced)
    result.warnings.push_back(
        "every model asked for was unstable; A was taken so that it is stable, at some bias");
  if (const auto K = kalman_gain(model.A, model.C, projection.noise_covariance(model)))
    model.K = *K;
  else
    result.warnings.push_back(
        "the model has no Kalman gain: its Riccati equation has no checked solution");
  if (recipe.operating_point == OperatingPoint::recent)
    model.y0 += recent_operating_point(
        work().y.topRows(rows_.size()) - free_run(model, work(), {0, rows_.size()}), true);
  result.model = in_units(model, normalisation_);
  if (!is_well_formed(result.model)) return std::nullopt;
  result.recipe = recipe;
  result.spectral_radius = spectral_radius(result.model);
  result.singular_values = std::move(singular_values);
  result.hankel_condition = hankel.least_share;
  result.search_work = work_spent_;
  describe(result);
  if (!result.x0.allFinite()) return std::nullopt;
  return result;
}

void Identification::describe(Identified& result) const {
  const Index m = record_.u.cols();
  result.input_min = all_sums_.least().head(m);
  result.input_max = all_sums_.greatest().head(m);
  result.x0 =
      estimate_initial_state(result.model, record_, segments_within(record_, rows_), state_rows);
}

}  // namespace

IdentifyResult run_pipeline(const Record& record, RowRange rows, const IdentifyOptions& options,
                            LagSums* kept) {
  if (kept) return Identification(record, rows, options, *kept, true).run();
  constexpr Index chunk_ticks = 1024;
  LagSums own({record.u.cols() + record.y.cols(), block_rows_needed(options), chunk_ticks});
  return Identification(record, rows, options, own, false).run();
}

}  // namespace reident::identification
