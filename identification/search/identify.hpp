// N4SID with the order, the horizon, the weighting and the way of B and D chosen by score on
// held-out samples: the entrance to this library (METHOD.md). Nothing here throws but what the
// caller's functions throw.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "identification/numerics/for_each.hpp"
#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/recipe.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::identification {

/// What may be fixed; the rest is chosen. The defaults suit a window of telemetry.
struct IdentifyOptions {
  /// What verdicts and warnings call the channels; empty: "input 1" and so on.
  std::vector<std::string> input_names, output_names;
  /// Absent: chosen in [min_order, max_order]. A model of order 0 has no dynamics: y follows u in
  /// the same row.
  std::optional<int> order;
  int min_order = 0;
  int max_order = 10;
  /// Block rows s, the way of B and D, and whether D may differ from zero. Absent: chosen.
  std::optional<int> horizon;
  std::optional<Weighting> weighting;
  std::optional<ResponseFit> response_fit;
  std::optional<bool> direct_feedthrough;
  /// A model with a slower mode [s] gives way to the best one without that explains the outputs.
  double longest_time_constant_s = std::numeric_limits<double>::infinity();
  /// Whether A may be made stable where every model is unstable; the recipe then says so.
  bool may_enforce_stability = true;
  /// Samples, one for each input; empty: none.
  std::vector<int> input_delays;
  /// Delays are looked for, each at most so many samples; 0: they are not. Absent: as long ones as
  /// the rows show.
  std::optional<int> max_input_delay = 0;
  /// The last so many inputs are those of operating regimes: they have an effect only where the
  /// model with them errs at least 5 % less on held-out rows. Fewer than the inputs.
  int regime_inputs = 0;
  /// Share of the identification rows that choices are scored on, in (0, 0.9]: the last ones and
  /// the first ones are held out in turn, a half of the share at a time.
  double tune_share = 0.4;
  /// Above 0: the last so many of the identification rows are for the choices alone. Nothing is
  /// fitted to them and every candidate is scored on them once, in place of what tune_share says.
  Index tune_rows = 0;
  /// What the choice may spend, in multiply-adds of free runs and regressions: with it the search
  /// is as thorough as the rows allow, and the same on every machine. Positive.
  double search_budget = 6e8;
  /// Whether Identified::gain_uncertainty is asked for.
  bool wants_gain_uncertainty = false;
  /// Runs the independent parts of the search; absent: one after the other. The result does not
  /// depend on it.
  ForEach for_each;
  /// Called as each phase of the work begins, with the literal "prepare", "choose" or
  /// "identify"; for timing. May be called again for a further model.
  std::function<void(std::string_view phase)> on_phase;
};

/// Returns every mistake in the options, one sentence each; empty when they are usable.
std::vector<std::string> mistakes(const IdentifyOptions& options);

/// Returns the block rows that the sums of an identification with these options have to hold, at
/// most. Requires options without mistakes.
Index block_rows_needed(const IdentifyOptions& options);

/// Whether the inputs of operating regimes have an effect, and the errors of the choice. An error
/// is absent where there is no such model, or nothing was to be chosen.
struct RegimeChoice {
  bool are_used = false;
  std::optional<double> error_with, error_without;  // as Identified::held_out_error
};

/// A model with what is known of it.
struct Identified {
  StateSpaceModel model;
  Vector x0;  // n: state at the first identification row
  Recipe recipe;
  /// Samples; empty: none. Their states come after those of the order.
  std::vector<int> input_delays;
  double spectral_radius = 0;
  Vector singular_values;  // of the weighted oblique projection, descending
  /// HankelFactor::least_share: sums of products lose their digits where it is below 1e-9.
  double hankel_condition = 0;
  Vector input_min, input_max;  // m: range of each input in the identification rows
  /// Error of the choice: root mean square in deviations of the outputs, over all folds. Absent
  /// where nothing was to be chosen.
  std::optional<double> held_out_error;
  /// gain_uncertainty() (p x m), where it was asked for and there is one.
  std::optional<Matrix> gain_uncertainty;
  /// Where IdentifyOptions::regime_inputs asked for one.
  std::optional<RegimeChoice> regimes;
  double search_work = 0;  // spent of the budget
  /// Sentences for an operator: what was left out, or could not be done.
  std::vector<std::string> warnings;
};

/// A model, or why there is none.
using IdentifyResult = std::variant<Identified, Verdict>;

/// Identifies a model from the rows `rows` of the record alone. Its x0 depends on the others too
/// where holes follow the first row: on their number, and on how much their inputs change.
/// Requires m >= 0 inputs, more than those of regimes where there are such, p >= 1 outputs, rows
/// within the record and options without mistakes. With `kept`, sums kept there stand for the
/// samples that they were made of, and new ones are added; not with input delays. Its shape has m +
/// p channels and at least block_rows_needed(options) block rows. Returns a verdict where the rows
/// give no model; whatever values they hold, one of the two comes. The result is the same to the
/// last bit for any `for_each`, and whatever sums of its shape `kept` holds.
IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options,
                        LagSums* kept = nullptr);

}  // namespace reident::identification
