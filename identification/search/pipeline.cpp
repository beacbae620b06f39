#include "identification/search/pipeline.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "identification/fit/gain_uncertainty.hpp"
#include "identification/search/closed_loop.hpp"
#include "identification/search/inseparable_inputs.hpp"
#include "identification/search/prepared_rows.hpp"
#include "identification/search/realisation.hpp"
#include "identification/search/recipe_choice.hpp"

namespace reident::identification {
namespace {

/// The best recipe that gives a model of all fitted rows, and one that is not too slow where a
/// model without slower modes explains the outputs as well.
IdentifyResult best_model(PreparedRows& rows, const RecipeChoice& choice,
                          const std::vector<std::string>& warnings) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const IdentifyOptions& options = rows.options();
  const double longest = options.longest_time_constant_s;
  std::optional<Identified> best;
  for (const ScoredRecipe& candidate : choice.ranked) {
    if (options.on_phase) options.on_phase("identify");
    // A model that does not explain the outputs takes no other one's place.
    if (best && !(candidate.error < choice.acceptable_error)) break;
    auto identified = realise(rows, candidate.recipe, best ? longest : infinity);
    if (!identified) continue;
    const double slowest = slowest_time_constant_s(identified->model);
    if (best && slowest > longest) continue;
    if (std::isfinite(candidate.error)) identified->held_out_error = candidate.error;
    identified->search_work = choice.work_spent;
    identified->warnings.insert(identified->warnings.begin(), warnings.begin(), warnings.end());
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

IdentifyResult run(PreparedRows rows) {
  const IdentifyOptions& options = rows.options();
  std::vector<std::string> warnings;
  if (options.on_phase) options.on_phase("prepare");
  if (auto verdict = rows.prepare(warnings)) return *std::move(verdict);
  if (options.on_phase) options.on_phase("choose");
  const auto choice = choose_recipes(rows, warnings);
  if (const auto* verdict = std::get_if<Verdict>(&choice)) return *verdict;
  IdentifyResult result = best_model(rows, std::get<RecipeChoice>(choice), warnings);
  auto* found = std::get_if<Identified>(&result);
  if (found && found->held_out_error)
    if (auto verdict = closed_loop_verdict(rows, *found, found->warnings))
      return *std::move(verdict);
  if (found && options.wants_gain_uncertainty)
    found->gain_uncertainty =
        gain_uncertainty(found->model, found->recipe.direct, rows.record(), rows.fitted());
  if (found)
    for (std::string& sentence : inseparable_inputs(rows, *found))
      found->warnings.push_back(std::move(sentence));
  return result;
}

}  // namespace

IdentifyResult run_pipeline(const Record& record, RowRange rows, const IdentifyOptions& options,
                            LagSums* kept) {
  if (kept) return run({record, rows, options, *kept, true});
  constexpr Index chunk_ticks = 1024;
  LagSums own({record.u.cols() + record.y.cols(), block_rows_needed(options), chunk_ticks});
  return run({record, rows, options, own, false});
}

}  // namespace reident::identification
