#include "identification/search/identify.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "identification/numerics/decompositions.hpp"
#include "identification/search/delay_search.hpp"
#include "identification/search/delays.hpp"
#include "identification/search/drift.hpp"
#include "identification/search/finite_check.hpp"
#include "identification/search/horizons.hpp"
#include "identification/search/pipeline.hpp"
#include "identification/search/regimes.hpp"
#include "identification/simulation/initial_state.hpp"

namespace reident::identification {

std::vector<std::string> mistakes(const IdentifyOptions& options) {
  std::vector<std::string> found;
  if (options.order && *options.order < 0) found.push_back("the order must not be negative");
  if (options.min_order < 0) found.push_back("the smallest order must not be negative");
  if (options.max_order < options.min_order)
    found.push_back("the largest order must not be below the smallest");
  if (options.horizon && *options.horizon < 2) found.push_back("the horizon must be at least 2");
  if (!(options.tune_share > 0 && options.tune_share <= 0.9))
    found.push_back("the tuning share must be above 0 and at most 0.9");
  for (const int delay : options.input_delays)
    if (delay < 0) found.push_back("an input delay must not be negative");
  if (options.regime_inputs < 0)
    found.push_back("the number of inputs of regimes must not be negative");
  if (options.max_input_delay.value_or(0) < 0)
    found.push_back("the largest input delay must not be negative");
  if (options.max_input_delay.value_or(0) > 0 && !options.input_delays.empty())
    found.push_back("the input delays are either given or chosen, not both");
  if (!(options.longest_time_constant_s > 0))
    found.push_back("the longest time constant must be positive");
  if (!(options.search_budget > 0)) found.push_back("the search budget must be positive");
  return found;
}

Index block_rows_needed(const IdentifyOptions& options) {
  return 2 * Index{longest_horizon(options)};
}

namespace {

/// Identifies a model of the inputs with these delays, which become states.
IdentifyResult identify_delayed(const Record& record, RowRange rows, const std::vector<int>& delays,
                                const IdentifyOptions& options) {
  const int longest = *std::max_element(delays.begin(), delays.end());
  const Record shifted = delayed_to_identify(record, rows, delays);
  IdentifyResult result = run_pipeline(shifted, shifted.all(), options, nullptr);
  auto* found = std::get_if<Identified>(&result);
  if (!found || longest == 0) return result;
  found->model = with_delay_states(found->model, delays);
  found->input_delays = delays;
  for (std::size_t i = 0; i < delays.size(); ++i)
    if (delays[i] > 0)
      found->warnings.push_back(channel_name("input", static_cast<Index>(i), options.input_names) +
                                " acts after " + std::to_string(delays[i]) +
                                " samples, which the model holds as as many states");
  found->x0 =
      estimate_initial_state(found->model, record, segments_within(record, rows), state_rows);
  return result;
}

/// Takes a model with one mode less, which is near 0, and delays that are longer by a row in its
/// place: of one input, or of all. Returns whether rows held out agree to one.
bool replace_pole_by_delay(Identified& found, const Record& record, RowRange rows,
                           IdentifyOptions options) {
  const Matrix A = without_delay_states(found.model, found.input_delays).A;
  if (options.order || A.rows() <= options.min_order ||
      eigenvalues(A).cwiseAbs().minCoeff() > pole_near_zero)
    return false;
  options.order = static_cast<int>(A.rows()) - 1;
  const int most = options.max_input_delay.value_or(std::numeric_limits<int>::max());
  for (const std::vector<int>& delays : longer_by_a_row(found.input_delays)) {
    if (*std::max_element(delays.begin(), delays.end()) > most) continue;
    IdentifyResult result = identify_delayed(record, rows, delays, options);
    auto* fewer = std::get_if<Identified>(&result);
    if (!fewer) continue;
    found.search_work += fewer->search_work;
    if (!held_out_rows_agree(*fewer, found, record, rows, options)) continue;
    fewer->search_work = found.search_work;
    found = std::move(*fewer);
    return true;
  }
  return false;
}

/// Names the inputs that act after more samples than delays may have; empty where none does.
std::string too_long_delays(const std::vector<int>& delays, int most,
                            const IdentifyOptions& options) {
  std::string found;
  for (std::size_t i = 0; i < delays.size(); ++i)
    if (delays[i] > most)
      found += (found.empty() ? "" : "; ") +
               channel_name("input", static_cast<Index>(i), options.input_names) +
               " seems to act after " + std::to_string(delays[i]) +
               " samples: delays were looked for up to " + std::to_string(most) +
               ", as --max-delay says";
  return found;
}

/// Adds a sentence to what an operator is told.
void tell(IdentifyResult& result, const std::string& sentence) {
  if (auto* found = std::get_if<Identified>(&result))
    found->warnings.push_back(sentence);
  else
    std::get<Verdict>(result).reason += "; " + sentence;
}

/// Identifies a model without delays, and one with those that the rows show where rows held out
/// agree.
IdentifyResult identify_with_shown_delays(const Record& record, RowRange rows,
                                          const IdentifyOptions& options, LagSums* kept) {
  constexpr Index usually_most = 60;
  constexpr int any = std::numeric_limits<int>::max();
  IdentifyResult result = run_pipeline(record, rows, options, kept);
  auto* without = std::get_if<Identified>(&result);
  if (!without && std::get<Verdict>(result).code != VerdictCode::no_better_than_mean) return result;
  const int most =
      options.max_input_delay.value_or(static_cast<int>(std::min(usually_most, rows.size() / 8)));
  std::vector<int> delays =
      delays_shown(record, rows, {without ? most : any, any}, without, options);
  const std::string too_long =
      options.max_input_delay ? too_long_delays(delays, most, options) : "";
  if (!too_long.empty()) {
    tell(result, too_long);
    delays = delays_shown(record, rows, {most, most}, without, options);
  }
  if (std::all_of(delays.begin(), delays.end(), [](int delay) { return delay == 0; }))
    return result;
  IdentifyResult with = identify_delayed(record, rows, delays, options);
  auto* found = std::get_if<Identified>(&with);
  if (!found) return result;
  if (without) {
    found->search_work += without->search_work;
    if (!held_out_rows_agree(*found, *without, record, rows, options)) return result;
  }
  while (replace_pole_by_delay(*found, record, rows, options)) {
  }
  if (!too_long.empty()) tell(with, too_long);
  return with;
}

/// Identifies from the rows, as the options say of regimes and delays.
IdentifyResult identify_rows(const Record& record, RowRange rows, const IdentifyOptions& options,
                             LagSums* kept) {
  if (options.regime_inputs > 0)
    return identify_with_regimes(record, rows, options, kept, identify_rows);
  if (record.u.cols() == 0) return run_pipeline(record, rows, options, kept);
  if (!options.input_delays.empty()) {
    if (auto verdict = non_finite_values(record, rows, options)) return *verdict;
    return identify_delayed(record, rows, options.input_delays, options);
  }
  if (options.max_input_delay != 0) return identify_with_shown_delays(record, rows, options, kept);
  return run_pipeline(record, rows, options, kept);
}

}  // namespace

IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options,
                        LagSums* kept) {
  assert(mistakes(options).empty() && record.y.cols() >= 1);
  assert(rows.begin >= 0 && rows.begin <= rows.end && rows.end <= record.rows());
  return identify_despite_drift(record, rows, options, kept, identify_rows);
}

}  // namespace reident::identification
