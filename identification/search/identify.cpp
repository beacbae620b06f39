#include "identification/search/identify.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

#include "identification/fit/output_error_fit.hpp"
#include "identification/search/delays.hpp"
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

/// The error on rows held out, and the order, with these delays; infinite where there is no model.
struct DelayedError {
  double error = std::numeric_limits<double>::infinity();
  int order = 0;
};

DelayedError error_with(const Record& record, RowRange rows, const std::vector<int>& delays,
                        const IdentifyOptions& options) {
  const Record shifted = delayed(record, rows, delays, options.max_input_delay);
  const IdentifyResult result = run_pipeline(shifted, shifted.all(), options, nullptr);
  const auto* found = std::get_if<Identified>(&result);
  if (!found || !found->held_out_error) return {};
  return {*found->held_out_error, found->recipe.order};
}

/// The channels, each less its mean and over its deviation.
Record standardised(Record record) {
  for (Matrix* channels : {&record.u, &record.y}) {
    channels->rowwise() -= Eigen::RowVectorXd(channels->colwise().mean());
    for (Index c = 0; c < channels->cols(); ++c)
      if (const double norm = channels->col(c).norm(); norm > 0)
        channels->col(c) *= std::sqrt(double(record.rows())) / norm;
  }
  return record;
}

/// The delays with which models of one order err least on the rows that they are fitted to, since a
/// delay takes no parameter: each input in turn, twice where there are several. One is kept where
/// it lowers the error by more than 1 %.
std::vector<int> delays_of_order(const Record& record, RowRange rows, int order, bool direct,
                                 const IdentifyOptions& options) {
  constexpr double worthwhile = 0.99;
  constexpr int steps = 10;
  const int most = options.max_input_delay;
  const Matrix start = Vector::LinSpaced(order, 0.95, order == 1 ? 0.95 : 0.3).asDiagonal();
  StateSpaceModel last;
  const auto error_with = [&](const std::vector<int>& tried) {
    const Record shifted = standardised(delayed(record, rows, tried, most));
    Response best = refine_response(start, Matrix::Ones(record.y.cols(), order), direct, shifted,
                                    shifted.all(), steps);
    if (last.order() == order)
      if (Response from_last =
              refine_response(last.A, last.C, direct, shifted, shifted.all(), steps);
          from_last.error < best.error)
        best = std::move(from_last);
    last = best.model;
    return best.error;
  };
  std::vector<int> delays(static_cast<std::size_t>(record.u.cols()), 0);
  for (int pass = 0; pass < (delays.size() > 1 ? 2 : 1); ++pass)
    for (int& delay : delays) {
      delay = 0;
      double least = worthwhile * error_with(delays);
      int best = 0;
      for (delay = 1; delay <= most; ++delay)
        if (const double error = error_with(delays); error < least) {
          least = error;
          best = delay;
        }
      delay = best;
    }
  return delays;
}

/// A model with too short a delay imitates the rest of it by poles. So delays come from models of
/// low orders; of those with which the whole search errs least, to 1 %, the lowest order is taken.
/// Delays with D = 0 come first: with D, one that is longer by a row gives the same outputs.
std::vector<int> chosen_delays(const Record& record, RowRange rows,
                               const IdentifyOptions& options) {
  constexpr double equal_errors = 1.01;
  std::vector<std::vector<int>> tried{std::vector<int>(static_cast<std::size_t>(record.u.cols()))};
  for (const int order : options.order ? std::vector{*options.order} : std::vector{1, 2, 4}) {
    if (!options.order && order > options.max_order) continue;
    for (const bool direct : {false, true}) {
      if (direct != options.direct_feedthrough.value_or(direct)) continue;
      auto delays = delays_of_order(record, rows, order, direct, options);
      if (std::find(tried.begin(), tried.end(), delays) == tried.end())
        tried.push_back(std::move(delays));
    }
  }
  std::vector<DelayedError> errors;
  for (const std::vector<int>& delays : tried)
    errors.push_back(error_with(record, rows, delays, options));
  const auto less = [](const DelayedError& a, const DelayedError& b) { return a.error < b.error; };
  const double least = std::min_element(errors.begin(), errors.end(), less)->error;
  std::size_t best = 0;
  const auto key = [&](std::size_t i) {
    const bool equal = errors[i].error <= equal_errors * least;
    return std::tuple(!equal, equal ? errors[i].order : 0, equal ? 0.0 : errors[i].error);
  };
  for (std::size_t i = 1; i < tried.size(); ++i)
    if (key(i) < key(best)) best = i;
  return tried[best];
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
  if (options.regime_inputs > 0)
    return identify_with_regimes(
        record, rows, options, kept,
        [rows](const Record& own, const IdentifyOptions& own_options, LagSums* own_kept) {
          return identify(own, rows, own_options, own_kept);
        });
  const bool may_delay = options.max_input_delay > 0 || !options.input_delays.empty();
  if (may_delay && record.u.cols() > 0) return identify_delayed(record, rows, options);
  return run_pipeline(record, rows, options, kept);
}

}  // namespace reident::identification
