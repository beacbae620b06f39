// N4SID with the order, the horizon, the weighting and the way of B and D chosen by score on
// held-out samples.
//
// The reference is P. Van Overschee and B. De Moor, "N4SID: Subspace algorithms for the
// identification of combined deterministic-stochastic systems", Automatica 30(1), 1994; METHOD.md
// holds the notation and the equations.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/model_search.hpp"
#include "identification/simulation/simulate.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/subspace.hpp"

namespace reident::identification {

struct IdentifyOptions {
  /// What verdicts and warnings call the channels; empty: "input 1" and so on.
  std::vector<std::string> input_names, output_names;
  std::optional<int> order;  // absent: chosen in [min_order, max_order]
  int min_order = 1;
  int max_order = 10;
  std::optional<int> horizon;               // block rows s; absent: chosen
  std::optional<Weighting> weighting;       // absent: chosen
  std::optional<ResponseFit> response_fit;  // the way of B and D; absent: chosen
  std::optional<bool> direct_feedthrough;   // whether D may differ from zero; absent: chosen
  /// A model with a slower mode gives way to the best one without that explains the outputs.
  double longest_time_constant_s = std::numeric_limits<double>::infinity();
  /// Whether A may be made stable where every model is unstable; the recipe then says so.
  bool may_enforce_stability = true;
  std::vector<int> input_delays;  // samples, one for each input; empty: none
  int max_input_delay = 0;        // above 0: the delays are estimated, each at most so many samples
  /// Share of the identification rows that choices are scored on, in (0, 0.9]: the last ones and
  /// the first ones are held out in turn, a half of the share at a time.
  double tune_share = 0.4;
  /// Above 0: the last so many of the identification rows are for the choices alone. Nothing is
  /// fitted to them and every candidate is scored on them once, in place of what tune_share says.
  Index tune_rows = 0;
  /// What the choice may spend, in multiply-adds of free runs and regressions: with it the search
  /// is as thorough as the rows allow, and the same on every machine. Positive.
  double search_budget = 6e8;
  /// Runs the independent parts of the search; absent: one after the other. The result does not
  /// depend on it.
  ForEach for_each;
  /// Called as each phase of the work begins, with a literal such as "compress"; for timing.
  std::function<void(std::string_view phase)> on_phase;
};

/// Every mistake in the options, one sentence each; empty when they are usable.
std::vector<std::string> mistakes(const IdentifyOptions& options);

/// Block rows that the sums of an identification with these options have to hold, at most.
Index block_rows_needed(const IdentifyOptions& options);

struct Identified {
  StateSpaceModel model;
  Vector x0;  // state at the first identification row
  Recipe recipe;
  std::vector<int>
      input_delays;  // samples; empty: none. Their states come after those of the order
  double spectral_radius = 0;
  Vector singular_values;       // of the weighted oblique projection, descending
  double hankel_condition = 0;  // least share of a Hankel row that those before it leave, squared
  Vector input_min, input_max;  // range visited by each input in the identification rows
  std::optional<double> held_out_error;  // of the choice: rms in deviations of the outputs, over
                                         // all folds; absent where nothing was to be chosen
  double search_work = 0;                // spent of the budget
  std::vector<std::string> warnings;
};

using IdentifyResult = std::variant<Identified, Verdict>;

/// Identifies from the rows `rows` of the record alone; nothing else of it is read.
/// Requires m >= 0 inputs, p >= 1 outputs and mistakes(options).empty(). With `kept`, whose shape
/// has the record's channels and at least block_rows_needed(options) block rows, sums kept there
/// stand for the samples that they were made of, and new ones are added; not with input delays.
IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options,
                        LagSums* kept = nullptr);

}  // namespace reident::identification
