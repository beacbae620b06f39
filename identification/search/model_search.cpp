#include "identification/search/model_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identification/fit/output_error_fit.hpp"
#include "identification/search/candidates.hpp"
#include "identification/search/mode_elimination.hpp"
#include "identification/search/parsimony.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/subspace/hankel.hpp"
#include "identification/subspace/input_response.hpp"
#include "identification/subspace/projection.hpp"

namespace reident::identification {
namespace {

constexpr double foretold = 0.5;  // of the error without slow modes
constexpr int refinement_steps = 25;
constexpr Index least_scored = 1000,
                most_scored = 2000;  // rows of a fold in the first stage
constexpr Index least_fitted = 2000;
constexpr double intended_recipes = 8;  // of the second stage, where rows are many

const HeldOutErrors no_model{{std::numeric_limits<double>::infinity(), {}},
                             {std::numeric_limits<double>::infinity(), {}}};

/// Multiply-adds of a run of one row.
double work_of_run(Index n, Index m, Index p) {
  return double((n + p) * (n + m));
}

class Search {
 public:
  Search(const SearchData& data, const SearchSpace& space, const ForEach& for_each,
         SearchEffort& effort)
      : data_(data),
        space_(space),
        for_each_(for_each),
        effort_(effort),
        least_rate_(space.least_rate),
        m_(data.normalised.u.cols()),
        p_(data.normalised.y.cols()) {}

  std::vector<ScoredRecipe> run();

 private:
  /// Scores every order, horizon and weighting with B and D from the compression.
  std::vector<Candidate> compressed_stage();
  /// Whether the inputs drive slower modes than the candidates of the first stage have.
  bool shows_slow_modes(const std::vector<Candidate>& compressed) const;
  void score_compressed(std::size_t fold, std::size_t horizon);
  /// Order, horizon and weighting of a place in the table of the first stage.
  Recipe recipe_at(std::size_t place) const;
  Index rows_scored_quickly() const;

  std::vector<Candidate> simulated_stage(std::vector<Candidate> compressed);
  std::vector<Candidate> refined_stage(const std::vector<Candidate>& simulated);
  /// The candidate of the lowest order that nothing speaks against beside the winner.
  std::optional<Candidate> simplest(const Candidate& winner,
                                    const std::vector<Candidate>& compressed);
  /// The winner with outputs that weigh by what they err, where it errs less so.
  std::optional<Candidate> weighted(const Candidate& winner);
  Response fit_of(const Candidate& candidate, std::size_t fold, RowRange rows) const;
  bool has_order_zero() const {
    return space_.min_order == 0 && m_ > 0 && space_.direct.front() &&
           space_.fits.front() == ResponseFit::simulation;
  }
  /// Fits and scores the candidates on the folds with no more than so many fitted rows.
  std::vector<Candidate> scored(std::vector<Candidate> candidates, Index rows_of_fold);
  HeldOutErrors errors_on(const Candidate& candidate, std::size_t fold, Index rows_of_fold) const;
  /// The first candidates for which a third of the budget lasts, at least one.
  std::vector<Candidate> affordable(const std::vector<Candidate>& candidates,
                                    Index rows_of_fold) const;
  double work_of(const Candidate& candidate, Index rows_of_fold) const;
  Index affordable_rows_of_fold(const Recipe& recipe, double recipes) const;

  std::size_t folds() const { return data_.folds.size(); }
  /// Orders of the first stage, which has no order 0.
  int least_order() const { return std::max(1, space_.min_order); }
  std::size_t orders() const {
    return static_cast<std::size_t>(space_.max_order - least_order() + 1);
  }
  std::size_t places_of_horizon() const { return space_.weightings.size() * orders(); }

  const SearchData& data_;
  const SearchSpace& space_;
  const ForEach& for_each_;
  SearchEffort& effort_;
  double least_rate_;  // 0 once slow modes have shown
  Index m_, p_;
  // What the first stage has found. A second look, with slow modes, goes on from it.
  struct Compressed {
    Projection projection;
    std::vector<Matrix> gammas;  // of each weighting
  };
  std::vector<std::optional<Compressed>> compressed_;  // by horizon and fold
  std::vector<std::vector<StateSpaceModel>> models_;   // by fold and place, as the errors
  std::vector<std::vector<HeldOutErrors>> errors_;
};

Recipe Search::recipe_at(std::size_t place) const {
  const std::size_t in_horizon = place % places_of_horizon();
  Recipe recipe;
  recipe.horizon = space_.horizons[place / places_of_horizon()];
  recipe.weighting = space_.weightings[in_horizon / orders()];
  recipe.order = least_order() + static_cast<int>(in_horizon % orders());
  recipe.stability = space_.stability;
  recipe.direct = space_.direct.front();
  recipe.least_rate = least_rate_;
  return recipe;
}

Index Search::rows_scored_quickly() const {
  double one_row = 0;
  for (int n = least_order(); n <= space_.max_order; ++n) one_row += work_of_run(n, m_, p_);
  one_row *= double(folds() * space_.horizons.size() * space_.weightings.size());
  return std::clamp(static_cast<Index>(effort_.budget / 3 / one_row), least_scored, most_scored);
}

void Search::score_compressed(std::size_t fold_index, std::size_t horizon_index) {
  const Record& record = data_.normalised;
  const Fold fold = data_.folds[fold_index].with_tune_of(rows_scored_quickly());
  const RangeSums& sums = data_.sums[fold_index];
  std::optional<Compressed>& compressed = compressed_[horizon_index * folds() + fold_index];
  if (!compressed) {
    compressed = Compressed{.projection = Projection(compress(sums, data_.normalisation, record,
                                                              segments_within(record, fold.fit),
                                                              space_.horizons[horizon_index])),
                            .gammas = {}};
    for (const Weighting weighting : space_.weightings)
      compressed->gammas.push_back(compressed->projection.observability(weighting).gamma);
  }
  const Vector mean = sums.mean();
  for (std::size_t w = 0; w < space_.weightings.size(); ++w) {
    const Matrix& gamma = compressed->gammas[w];
    for (std::size_t i = 0; i < orders(); ++i) {
      const std::size_t place = horizon_index * places_of_horizon() + w * orders() + i;
      const Recipe recipe = recipe_at(place);
      if (recipe.order > gamma.cols() - p_) break;
      const auto found = shift_invariant_within({fold.fit.size(), recipe.least_rate}, gamma, p_,
                                                recipe.order, recipe.stability);
      StateSpaceModel& model = models_[fold_index][place];
      HeldOutErrors& errors = errors_[fold_index][place];
      if (!found) {
        model = {};
        errors = no_model;
        continue;
      }
      if (model.order() == found->A.rows() && model.A == found->A && model.C == found->C) continue;
      model =
          with_response(compressed->projection, found->A, found->C, recipe.direct, record.period_s);
      set_operating_point(model, data_.normalisation, mean);
      errors = quick_held_out_errors(model, record, fold);
    }
  }
}

std::vector<Candidate> Search::compressed_stage() {
  if (orders() == 0) return {};
  const std::size_t places = space_.horizons.size() * places_of_horizon();
  compressed_.resize(space_.horizons.size() * folds());
  models_.resize(folds(), std::vector<StateSpaceModel>(places));
  errors_.resize(folds(), std::vector<HeldOutErrors>(places, no_model));
  for_each_(compressed_.size(),
            [this](std::size_t task) { score_compressed(task % folds(), task / folds()); });
  std::vector<Candidate> found;
  for (std::size_t place = 0; place < places; ++place) {
    std::vector<HeldOutErrors> own;
    for (const std::vector<HeldOutErrors>& of_fold : errors_) own.push_back(of_fold[place]);
    Candidate candidate{place, recipe_at(place), 0};
    if (!take_errors(candidate, own)) continue;
    for (const Fold& fold : data_.folds)
      effort_.spent += work_of_run(candidate.recipe.order, m_, p_) *
                       double(fold.with_tune_of(rows_scored_quickly()).tune.size());
    found.push_back(std::move(candidate));
  }
  rank(found);
  return found;
}

bool Search::shows_slow_modes(const std::vector<Candidate>& compressed) const {
  // With the most modes, since whatever is missing may look slow.
  Candidate candidate = *std::max_element(
      compressed.begin(), compressed.end(),
      [](const auto& a, const auto& b) { return a.recipe.order < b.recipe.order; });
  candidate.recipe.fit = ResponseFit::simulation;
  const RowRange rows =
      data_.folds.front().with_fit_of(affordable_rows_of_fold(candidate.recipe, 1)).fit;
  // A mode near the least rate stands for a slower one: without it there is more to see.
  const StateSpaceModel& model = models_[0][candidate.place];
  const Dynamics fast = without_slow_modes({model.A, model.C}, 2 * least_rate_);
  const Response fit =
      fit_response(fast.A, fast.C, candidate.recipe.direct, data_.normalised, rows, Accuracy::fast);
  if (drives_slow_modes(fit, data_.normalised, rows, least_rate_ / 2)) return true;
  // Errors that are sums of the inputs can look like a drift. No drift is foretold.
  const double line = held_out_error_of_sums(data_.normalised, data_.folds, {});
  const double sums = held_out_error_of_sums(data_.normalised, data_.folds, {0, least_rate_});
  return sums < foretold * std::min(line, compressed.front().error);
}

HeldOutErrors Search::errors_on(const Candidate& candidate, std::size_t fold_index,
                                Index rows_of_fold) const {
  const Record& record = data_.normalised;
  const Fold fold = data_.folds[fold_index].with_fit_of(rows_of_fold);
  if (candidate.recipe.fit == ResponseFit::simulation)
    return held_out_errors(fit_of(candidate, fold_index, fold.fit), record, fold);
  const StateSpaceModel& model = models_[fold_index][candidate.place];
  const std::vector<Segment> segments = segments_within(record, fold.fit);
  return held_out_errors(
      {model, estimate_initial_state(model, record, segments, initial_rows(model)), 0}, record,
      fold);
}

Response Search::fit_of(const Candidate& candidate, std::size_t fold, RowRange rows) const {
  const Recipe& recipe = candidate.recipe;
  const Record& record = data_.normalised;
  if (recipe.order == 0)
    return fit_response(Matrix(0, 0), Matrix(p_, 0), true, record, rows, Accuracy::fast);
  const StateSpaceModel& model = models_[fold][candidate.place];
  return recipe.refinement_steps > 0
             ? refined({model.A, model.C}, recipe, record, rows)
             : fit_response(model.A, model.C, recipe.direct, record, rows, Accuracy::fast);
}

std::vector<Candidate> Search::scored(std::vector<Candidate> candidates, Index rows_of_fold) {
  std::vector<HeldOutErrors> errors(candidates.size() * folds());
  for_each_(errors.size(), [&](std::size_t task) {
    errors[task] = errors_on(candidates[task / folds()], task % folds(), rows_of_fold);
  });
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto first = errors.begin() + static_cast<std::ptrdiff_t>(i * folds());
    effort_.spent += work_of(candidates[i], rows_of_fold);
    if (take_errors(candidates[i], {first, first + static_cast<std::ptrdiff_t>(folds())}))
      found.push_back(std::move(candidates[i]));
  }
  rank(found);
  return found;
}

double Search::work_of(const Candidate& candidate, Index rows_of_fold) const {
  Index rows = 0;
  for (const Fold& fold : data_.folds) rows += fold.with_fit_of(rows_of_fold).fit.size();
  return double(rows) * (candidate.recipe.fit == ResponseFit::subspace
                             ? work_of_run(candidate.recipe.order, m_, p_)
                             : work_of_regression(candidate.recipe, m_, p_));
}

Index Search::affordable_rows_of_fold(const Recipe& recipe, double recipes) const {
  return affordable_rows(recipe, m_, p_, effort_.budget / 3 / (recipes * double(folds())));
}

std::vector<Candidate> Search::affordable(const std::vector<Candidate>& candidates,
                                          Index rows_of_fold) const {
  std::vector<Candidate> taken;
  double work = 0;
  for (const Candidate& candidate : candidates) {
    work += work_of(candidate, rows_of_fold);
    if (!taken.empty() && work > effort_.budget / 3) break;
    taken.push_back(candidate);
  }
  return taken;
}

std::vector<Candidate> Search::simulated_stage(std::vector<Candidate> compressed) {
  if (compressed.empty()) return {};
  std::vector<Candidate> both_ways;
  for (const Candidate& candidate : by_turns(compressed))
    for (const ResponseFit fit : space_.fits) {
      both_ways.push_back(candidate);
      both_ways.back().recipe.fit = fit;
    }
  const Index rows = affordable_rows_of_fold(both_ways.front().recipe, intended_recipes);
  std::vector<Candidate> found = scored(affordable(both_ways, rows), rows);
  if (found.empty() || space_.direct.size() == 1 ||
      found.front().recipe.fit == ResponseFit::subspace)
    return found;
  Candidate other = found.front();
  other.recipe.direct = !other.recipe.direct;
  const std::vector<Candidate> without = scored({other}, rows);
  found.insert(found.end(), without.begin(), without.end());
  rank(found);
  return found;
}

std::vector<Candidate> Search::refined_stage(const std::vector<Candidate>& simulated) {
  if (simulated.empty() || simulated.front().error <= no_error) return {};
  Recipe first = simulated.front().recipe;
  first.refinement_steps = refinement_steps;
  const Index rows = affordable_rows_of_fold(first, 1);
  std::vector<Candidate> refined;
  for (const Candidate& candidate : simulated) {
    if (candidate.recipe.fit != ResponseFit::simulation) continue;
    refined.push_back(candidate);
    refined.back().recipe.refinement_steps = refinement_steps;
    refined.back().recipe.refined_rows = rows * static_cast<Index>(folds());
  }
  return refined.empty() ? refined : scored(affordable(refined, rows), rows);
}

std::optional<Candidate> Search::simplest(const Candidate& winner,
                                          const std::vector<Candidate>& compressed) {
  if (space_.fits.front() != ResponseFit::simulation) return std::nullopt;
  Candidate rich = winner;
  rich.recipe.fit = ResponseFit::simulation;
  rich.recipe.refinement_steps = refinement_steps;
  const Index rows = affordable_rows_of_fold(rich.recipe, 2);
  // The rows that the folds fit together.
  RowRange fitted = data_.folds.front().fit;
  for (const Fold& fold : data_.folds)
    fitted = {std::min(fitted.begin, fold.fit.begin), std::max(fitted.end, fold.fit.end)};
  fitted.begin = std::max(fitted.begin, fitted.end - rows);
  const auto segments = static_cast<Index>(segments_within(data_.normalised, fitted).size());
  const auto parameters = [&](const Recipe& recipe) {
    return parameters_of(recipe.order, m_, p_, recipe.direct, segments);
  };
  // Each is fitted twice, again to errors that are correlated.
  const auto fit = [&](const Candidate& candidate) {
    Recipe again = candidate.recipe;
    again.refinement_steps = again.order == 0 ? 0 : RicherFit::steps;
    for (const Recipe& recipe : {candidate.recipe, again})
      effort_.spent += work_of_regression(recipe, m_, p_) * double(fitted.size());
    return fit_of(candidate, 0, fitted);
  };
  const Fold& largest = data_.folds.front();
  std::optional<Response> rich_fit;
  std::optional<RicherFit> richer;
  std::vector<FewerModes> fewer;  // than the rich one's
  // Absent where something speaks against the simpler one.
  const auto accepted = [&](const Candidate& simple,
                            const Response& simple_fit) -> std::optional<Candidate> {
    const bool within_steps = errs_within_steps(simple_fit, data_.normalised, fitted);
    const Index extra = std::max<Index>(1, parameters(winner.recipe) - parameters(simple.recipe));
    if (!within_steps) {
      if (!richer) {
        rich_fit = fit(rich);
        richer.emplace(*rich_fit, rich.recipe.direct, data_.normalised, fitted, least_rate_);
      }
      if (richer->refutes(simple_fit, simple.recipe.direct, extra)) return std::nullopt;
    }
    std::vector<Candidate> result = scored({simple}, rows);
    if (result.empty()) return std::nullopt;
    if (within_steps) return std::move(result.front());
    const double together = richer->correlated_rows();
    if (errs_more(result.front().fold_errors, winner.fold_errors, extra,
                  double(largest.with_fit_of(rows).fit.size()) / together,
                  double(largest.tune.size()) / together))
      return std::nullopt;
    return std::move(result.front());
  };
  // What one order lacks, every lower one lacks.
  std::optional<Candidate> best;
  int refused = (has_order_zero() ? 0 : least_order()) - 1, taken = winner.recipe.order;
  const auto accepted_of = [&](int order) -> std::optional<Candidate> {
    const auto found = std::find_if(compressed.begin(), compressed.end(), [&](const Candidate& c) {
      return order == 0 || c.recipe.order == order;
    });
    if (found == compressed.end()) return std::nullopt;
    Candidate simple = *found;
    simple.recipe.order = order;
    simple.recipe.fit = ResponseFit::simulation;
    simple.recipe.direct = order == 0 || winner.recipe.direct;
    simple.recipe.refinement_steps = order == 0 ? 0 : refinement_steps;
    simple.recipe.refined_rows = order == 0 ? 0 : rows * static_cast<Index>(folds());
    const Response simple_fit = fit(simple);
    if (auto result = accepted(simple, simple_fit); result || order == 0 || !rich_fit)
      return result;
    // The refinement may have missed a mode that the winner has.
    if (fewer.empty())
      fewer = fewer_modes({rich_fit->model.A, rich_fit->model.C}, rich.recipe.direct,
                          data_.normalised, fitted, 1);
    const auto left = std::find_if(fewer.begin(), fewer.end(), [order](const FewerModes& modes) {
      return modes.dynamics.A.rows() <= order;
    });
    if (left == fewer.end() || left->dynamics.A.rows() <= refused ||
        !(left->error < equal_errors * simple_fit.error))
      return std::nullopt;
    Candidate eliminated = rich;
    eliminated.recipe.eliminated_from = rich.recipe.order;
    eliminated.recipe.order = static_cast<int>(left->dynamics.A.rows());
    eliminated.recipe.refined_rows = simple.recipe.refined_rows;
    return accepted(eliminated, fit(eliminated));
  };
  while (taken - refused > 1) {
    const int order = (refused + taken) / 2;
    if (auto simple = accepted_of(order)) {
      best = std::move(simple);
      taken = best->recipe.order;
    } else {
      refused = order;
    }
  }
  return best;
}

std::optional<Candidate> Search::weighted(const Candidate& winner) {
  if (p_ == 1 || winner.recipe.order == 0 || winner.recipe.fit != ResponseFit::simulation ||
      winner.error <= no_error)
    return std::nullopt;
  Candidate other = winner;
  other.recipe.weighted = true;
  other.recipe.refinement_steps = refinement_steps;
  const Index rows = affordable_rows_of_fold(other.recipe, 1);
  other.recipe.refined_rows = rows * static_cast<Index>(folds());
  const std::vector<Candidate> found = scored({other}, rows);
  if (found.empty() || found.front().error > equal_errors * winner.error ||
      found.front().log_error() >= winner.log_error())
    return std::nullopt;
  return found.front();
}

std::vector<ScoredRecipe> Search::run() {
  std::vector<Candidate> compressed = compressed_stage();
  if (least_rate_ > 0 && (compressed.empty() || shows_slow_modes(compressed))) {
    least_rate_ = 0;
    compressed = compressed_stage();
  }
  std::vector<Candidate> found = simulated_stage(compressed);
  const std::vector<Candidate> refined = refined_stage(found);
  if (!refined.empty() && refined.front().error <= equal_errors * found.front().error)
    found.insert(found.begin(), refined.front());
  if (orders() == 0 && has_order_zero()) {
    Candidate only;
    only.recipe.horizon = space_.horizons.front();
    only.recipe.fit = ResponseFit::simulation;
    found = scored({only}, affordable_rows_of_fold(only.recipe, 1));
  }
  if (!found.empty())
    if (auto simple = simplest(found.front(), compressed)) found.insert(found.begin(), *simple);
  if (!found.empty())
    if (auto other = weighted(found.front())) found.insert(found.begin(), *other);
  std::vector<ScoredRecipe> result;
  for (const Candidate& candidate : found) result.push_back({candidate.recipe, candidate.error});
  return result;
}

}  // namespace

double work_of_regression(const Recipe& recipe, Index m, Index p) {
  const Index n = recipe.subspace_order();
  const double columns = double(n + n * m + m + 2);
  // A step of the refinement walks the rows twice, once with more columns.
  return double(p) * (double(n * n * (m + 1)) + columns * columns / 2) *
         double(1 + 3 * recipe.refinement_steps);
}

Index affordable_rows(const Recipe& recipe, Index m, Index p, double work) {
  return std::max(least_fitted, static_cast<Index>(work / work_of_regression(recipe, m, p)));
}

std::vector<ScoredRecipe> ranked_recipes(const SearchData& data, const SearchSpace& space,
                                         const ForEach& for_each, SearchEffort& effort) {
  return Search(data, space, for_each, effort).run();
}

}  // namespace reident::identification
