#include "identification/search/identify.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "identification/search/delays.hpp"
#include "identification/search/finite_check.hpp"
#include "identification/search/horizons.hpp"
#include "identification/search/pipeline.hpp"
#include "identification/simulation/initial_state.hpp"

namespace reident::identification {

std::vector<std::string> mistakes(const IdentifyOptions& options) {
  std::vector<std::string> found;
  if (options.order && *options.order < 1) found.push_back("the order must be at least 1");
  if (options.min_order < 1) found.push_back("the smallest order must be at least 1");
  if (options.max_order < options.min_order)
    found.push_back("the largest order must not be below the smallest");
  if (options.horizon && *options.horizon < 2) found.push_back("the horizon must be at least 2");
  if (!(options.tune_share > 0 && options.tune_share <= 0.9))
    found.push_back("the tuning share must be above 0 and at most 0.9");
  for (const int delay : options.input_delays)
    if (delay < 0) found.push_back("an input delay must not be negative");
  if (options.max_input_delay < 0) found.push_back("the largest input delay must not be negative");
  if (options.max_input_delay > 0 && !options.input_delays.empty())
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

/// Tries each input's delay in turn, the structure being that of the model without any; one is kept
/// where it lowers the error on rows held out by more than 1 %.
std::vector<int> chosen_delays(const Record& record, RowRange rows,
                               const IdentifyOptions& options) {
  constexpr double worthwhile = 0.99;
  const int most = options.max_input_delay;
  std::vector<int> delays(static_cast<std::size_t>(record.u.cols()), 0);
  IdentifyOptions fixed = options;
  const auto error_with = [&](const std::vector<int>& tried) {
    const Record shifted = delayed(record, rows, tried, most);
    const IdentifyResult result = run_pipeline(shifted, shifted.all(), fixed, nullptr);
    const auto* found = std::get_if<Identified>(&result);
    if (found && !fixed.weighting) {
      fixed.order = found->recipe.order;
      fixed.horizon = found->recipe.horizon;
      fixed.weighting = found->recipe.weighting;
    }
    return found && found->held_out_error ? *found->held_out_error
                                          : std::numeric_limits<double>::infinity();
  };
  double least = error_with(delays);
  for (int& delay : delays) {
    int best = 0;
    double best_error = least;
    for (delay = 1; delay <= most; ++delay)
      if (const double error = error_with(delays); error < best_error) {
        best_error = error;
        best = delay;
      }
    delay = best_error < worthwhile * least ? best : 0;
    if (delay > 0) least = best_error;
  }
  return delays;
}

IdentifyResult identify_delayed(const Record& record, RowRange rows,
                                const IdentifyOptions& options) {
  if (auto verdict = non_finite_values(record, rows, options)) return *verdict;
  const std::vector<int> delays =
      options.input_delays.empty() ? chosen_delays(record, rows, options) : options.input_delays;
  const int longest = *std::max_element(delays.begin(), delays.end());
  const Record shifted = delayed(record, rows, delays, longest);
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

}  // namespace

IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options,
                        LagSums* kept) {
  assert(mistakes(options).empty() && record.y.cols() >= 1);
  assert(rows.begin >= 0 && rows.begin <= rows.end && rows.end <= record.rows());
  const bool may_delay = options.max_input_delay > 0 || !options.input_delays.empty();
  if (may_delay && record.u.cols() > 0) return identify_delayed(record, rows, options);
  return run_pipeline(record, rows, options, kept);
}

}  // namespace reident::identification
