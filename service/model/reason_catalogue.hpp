// The catalogue: every outcome and every reason, with its code in JSON and its sentence.
//
// A new reason is a code and a row here, the rule that gives it, and the two's tests. A sentence
// names each of its figures once, where it is to stand, with its format: {mrse_percent:.3f}. Rules
// give the figures in this order, and JSON has them under these names.
//
//   format               type
//   ...f, ...g           a real number
//   d                    an integer
//   time, duration       nanoseconds, as time_text and duration_text write them
//   none                 text
#pragma once

#include <optional>
#include <string_view>

#include "storage/types/registry_rows.hpp"

namespace reident {

/// What an attempt at a window comes to. One that the identification gives no model for has the
/// code of its verdict (identification/samples/verdict.hpp) as its outcome instead.
enum class Outcome {
  approved,
  waiting,            // good enough; the policy leaves the decision to an operator
  unvouched,          // better by a constant offset, which may be a sensor's; waits for an operator
  held,               // good enough; an operator holds the equipment's version
  on_probation,       // better, and nothing hurries; telemetry after the window decides
  unknown_parameter,  // telemetry has not described a parameter of the equipment yet
  telemetry_damaged,  // samples that the attempt needs cannot be decoded any more
  low_coverage,
  implausible,  // sensors contradict each other, or themselves, on too much of the window
  validation_says_nothing,
  not_finite,
  unstable,
  slower_than_window,  // a time constant that looks like an integrator's over the window
  error_above_limit,
  fit_below_limit,
  residual_out_of_range,
  inputs_out_of_range,
  not_better_than_baseline,
  older_than_champion,
  telemetry_in_doubt,  // so many sensor faults that more go unnoticed; the champion stays
  comparison_says_nothing,
  not_better_than_champion,
  disagrees_with_champion,
  too_soon,
};

struct OutcomeRow {
  Outcome outcome;
  std::string_view name;
  /// The version's first decision; absent where there is no version.
  std::optional<storage::DecisionKind> decision;
};

enum class ReasonCode {
  // There is no candidate.
  unknown_parameter,
  telemetry_damaged,
  low_coverage,
  low_coverage_with_derived,
  implausible,
  no_model,
  // The gate, against a candidate.
  validation_says_nothing,
  not_finite,
  unstable,
  slower_than_window,
  error_above_limit,
  fit_below_limit,
  fit_of_few_samples,
  fit_not_sure,
  residual_out_of_range,
  inputs_out_of_range,
  not_better_than_simulator,
  not_below_baseline,
  telemetry_in_doubt,
  comparison_says_nothing,
  not_surely_better,
  gain_within_noise,
  disagrees_with_champion,
  older_than_champion,
  too_soon,
  // The gate, for a candidate.
  first_version,
  champion_cannot_run,
  better_than_champion,
  // The gate, why a candidate waits.
  held,
  offset_unvouched,
  waits_for_operator,
  offset_not_sure,
  gain_near_noise,
  shorter_than_slowest,
  input_still,
  operation_unusual,
  hardly_changed,
  waits_for_telemetry,
  // The evaluation of a version on probation: what was compared, and for it.
  evaluated,
  evaluated_beside_offset,
  confirmed,
  // Against it, without an evaluation.
  unconfirmed_champion_withdrawn,
  unconfirmed_confirmation_off,
  unconfirmed_older,
  unconfirmed_too_soon,
  unconfirmed_damaged,
  unconfirmed_other_outputs,
  unconfirmed_nothing_left,
  // Against it, after an evaluation.
  unconfirmed_in_doubt,
  unconfirmed_above_limit,
  unconfirmed_nothing_after,
  unconfirmed_worse_after,
  unconfirmed_worse_with_window,
  unconfirmed_not_surely_less,
  unconfirmed_not_keeping_up,
  unconfirmed_within_noise,
  unconfirmed_input_still,
  unconfirmed_unusual,
  unconfirmed_no_change,
  unconfirmed_after_not_sure,
  unconfirmed_tenure_excluded,
  unconfirmed_as_in_tenure,
  unconfirmed_excursion,
};

struct ReasonRow {
  ReasonCode code;
  std::string_view name;
  /// What the attempt comes to when this is the last of its reasons; absent where it never is, or
  /// does not belong to an attempt.
  std::optional<Outcome> outcome;
  std::string_view sentence;
};

/// Rows are found by their code, in whatever order they and the enumerators are.
struct Catalogue {
  using O = Outcome;
  using enum storage::DecisionKind;
  using enum ReasonCode;
  static constexpr std::nullopt_t none = std::nullopt;

  static constexpr OutcomeRow outcomes[] = {
      {O::approved, "approved", approve},
      {O::waiting, "waiting", wait},
      {O::unvouched, "unvouched", wait},
      {O::held, "held", wait},
      {O::on_probation, "on_probation", wait},
      {O::unknown_parameter, "unknown_parameter", none},
      {O::telemetry_damaged, "telemetry_damaged", none},
      {O::low_coverage, "low_coverage", none},
      {O::implausible, "implausible", none},
      {O::validation_says_nothing, "validation_says_nothing", reject},
      {O::not_finite, "not_finite", reject},
      {O::unstable, "unstable", reject},
      {O::slower_than_window, "slower_than_window", reject},
      {O::error_above_limit, "error_above_limit", reject},
      {O::fit_below_limit, "fit_below_limit", reject},
      {O::residual_out_of_range, "residual_out_of_range", reject},
      {O::inputs_out_of_range, "inputs_out_of_range", reject},
      {O::not_better_than_baseline, "not_better_than_baseline", reject},
      {O::older_than_champion, "older_than_champion", reject},
      {O::telemetry_in_doubt, "telemetry_in_doubt", reject},
      {O::comparison_says_nothing, "comparison_says_nothing", reject},
      {O::not_better_than_champion, "not_better_than_champion", reject},
      {O::disagrees_with_champion, "disagrees_with_champion", reject},
      {O::too_soon, "too_soon", reject},
  };

  static constexpr ReasonRow reasons[] = {
      {unknown_parameter, "unknown_parameter", O::unknown_parameter,
       "Parameter {parameter} has not been described by telemetry yet; check its name in the "
       "configuration or wait for its descriptor."},
      {telemetry_damaged, "telemetry_damaged", O::telemetry_damaged, "{damage}"},
      {low_coverage, "low_coverage", O::low_coverage,
       "Only {coverage_percent:.1f} % of the window has every parameter valid; "
       "{min_coverage_percent:g} % are needed."},
      {low_coverage_with_derived, "low_coverage_with_derived", O::low_coverage,
       "Only {coverage_percent:.1f} % of the window has every parameter valid and every derived "
       "input finite; {min_coverage_percent:g} % are needed."},
      {implausible, "implausible", O::implausible,
       "Telemetry is not believed: {worst}. {coverage_percent:.1f} % of the window is left, "
       "{min_coverage_percent:g} % are needed."},
      {no_model, "no_model", none, "{verdict}"},

      {validation_says_nothing, "validation_says_nothing", O::validation_says_nothing,
       "An output does not move in the validation part, so that no score there can tell a good "
       "model from a bad one."},
      {not_finite, "not_finite", O::not_finite,
       "The model or its run holds numbers that are not finite."},
      {unstable, "unstable", O::unstable,
       "The model is unstable: its spectral radius is {spectral_radius:.6f}."},
      {slower_than_window, "slower_than_window", O::slower_than_window,
       "Its slowest time constant is {slowest_over_window:.3g} times the window's length, which "
       "cannot tell it: a long run would drift away."},
      {error_above_limit, "error_above_limit", O::error_above_limit,
       "MRSE {mrse_percent:.3f} % on unseen data is above the limit of {max_mrse_percent:g} %."},
      {fit_below_limit, "fit_below_limit", O::fit_below_limit,
       "Fit {fit_percent:.2f} % on unseen data is below the limit of {min_fit_percent:g} % (0 % is "
       "a constant at the mean)."},
      {fit_of_few_samples, "fit_of_few_samples", O::fit_below_limit,
       "Fit {fit_percent:.2f} % on {rows:d} unseen samples may be chance: they are too few, or too "
       "much of one stretch, to tell."},
      {fit_not_sure, "fit_not_sure", O::fit_below_limit,
       "Fit {fit_percent:.2f} % on unseen data may be chance: with a confidence of "
       "{confidence_percent:g} % it is not above 0 % (a constant at the mean)."},
      {residual_out_of_range, "residual_out_of_range", O::residual_out_of_range,
       "The largest error is {residual_over_span:.2f} times the output's range."},
      {inputs_out_of_range, "inputs_out_of_range", O::inputs_out_of_range,
       "On {outside_percent:.0f} % of the validation part an input is outside the range that the "
       "model was identified in: the score there is of an extrapolation."},
      {not_better_than_simulator, "not_better_than_simulator", O::not_better_than_baseline,
       "MRSE {mrse_percent:.3f} % does not surely undercut the simulator's own telemetry "
       "({simulator_mrse_percent:.3f} % on the same samples) by {margin_percent:g} %."},
      {not_below_baseline, "not_below_baseline", O::not_better_than_baseline,
       "MRSE {mrse_percent:.3f} % is not below the baseline's {baseline_mrse_percent:.3f} %."},
      {telemetry_in_doubt, "telemetry_in_doubt", O::telemetry_in_doubt,
       "{fault_percent:.2f} faults of sensors were found in 100 ticks: others that go unnoticed "
       "make any comparison doubtful, and champion {champion:d} stays."},
      {comparison_says_nothing, "comparison_says_nothing", O::comparison_says_nothing,
       "{rows:d} samples compare the candidate with champion {champion:d}: too few, or too much of "
       "one stretch, to tell."},
      {not_surely_better, "not_surely_better", O::not_better_than_champion,
       "MRSE {mrse_percent:.3f} % does not surely undercut champion {champion:d} "
       "({champion_mrse_percent:.3f} % on the same samples) by {margin_percent:g} %: the reduction "
       "is {reduction_percent:.2f} %, and {sure_reduction_percent:.2f} % with a confidence of "
       "{confidence_percent:g} %."},
      {gain_within_noise, "gain_within_noise", O::not_better_than_champion,
       "MRSE {mrse_percent:.3f} % undercuts champion {champion:d} ({champion_mrse_percent:.3f} % "
       "on the same samples) by too little beside the noise of the sensors ({noise_percent:.3f} "
       "%)."},
      {disagrees_with_champion, "disagrees_with_champion", O::disagrees_with_champion,
       "On {rows:d} samples of the window of champion {champion:d}, with inputs that this one was "
       "not validated with, the two differ by {disagreement_percent:.1f} % of the output's range, "
       "above the limit of {max_disagreement_percent:g} %, and the champion is nearer to the "
       "telemetry of that time."},
      {older_than_champion, "older_than_champion", O::older_than_champion,
       "Champion {champion:d} was identified from newer telemetry."},
      {too_soon, "too_soon", O::too_soon,
       "The window ends {since_ns:duration} after that of champion {champion:d}; versions are at "
       "least {min_interval_ns:duration} apart."},

      {first_version, "first_version", O::approved,
       "First version: MRSE {mrse_percent:.3f} %, fit {fit_percent:.1f} % on unseen data."},
      {champion_cannot_run, "champion_cannot_run", O::approved,
       "MRSE {mrse_percent:.3f} % on unseen data, on which champion {champion:d} cannot run."},
      {better_than_champion, "better_than_champion", O::approved,
       "MRSE {mrse_percent:.3f} % on unseen data; champion {champion:d} has "
       "{champion_mrse_percent:.3f} % on the same samples."},

      {held, "held", O::held, "Waits: {actor} holds the equipment ({reason})."},
      {offset_unvouched, "offset_unvouched", O::unvouched,
       "But for a constant offset the champion is not surely worse by {margin_percent:g} %, and a "
       "sensor of {sensors} would show the same; no relation binds it. Waits for an operator's "
       "approval."},
      {waits_for_operator, "waits_for_operator", O::waiting, "Waits for an operator's approval."},
      {offset_not_sure, "offset_not_sure", none,
       "But for a constant offset the champion has {champion_mrse_percent:.3f} %, which is not "
       "surely worse by {needed_percent:g} %."},
      {gain_near_noise, "gain_near_noise", none,
       "That is little less beside the noise of the sensors ({noise_percent:.3f} %)."},
      {shorter_than_slowest, "shorter_than_slowest", none,
       "But those are fewer than the slowest time constant of the two lasts ({slowest_rows:.0f})."},
      {input_still, "input_still", none,
       "But {input} stands still all over the window: it is stuck, or the operation is not the "
       "usual one."},
      {operation_unusual, "operation_unusual", none,
       "The inputs move over {movement_percent:.0f} % of the ranges that the champion was "
       "identified in: the operation is not the usual one."},
      {hardly_changed, "hardly_changed", none,
       "It had {champion_validated_mrse_percent:.3f} % where it was validated, so that the "
       "equipment has hardly changed."},
      {waits_for_telemetry, "waits_for_telemetry", O::on_probation,
       "Waits for {confirmation_ns:duration} of telemetry after its window, or for twice as much."},

      {evaluated, "evaluated", none,
       "MRSE {mrse_percent:.3f} % on {rows:d} samples of the validation part and after it, until "
       "{until_ns:time}; champion {champion:d} has {champion_mrse_percent:.3f} % there."},
      {evaluated_beside_offset, "evaluated_beside_offset", none,
       "MRSE {mrse_percent:.3f} % on {rows:d} samples of the validation part and after it, until "
       "{until_ns:time}; champion {champion:d} has {champion_mrse_percent:.3f} % there, "
       "{without_offset_percent:.3f} % but for a constant offset that no relation vouches for."},
      {confirmed, "confirmed", none,
       "Confirmed: the reduction is {reduction_percent:.2f} %, and with a confidence of "
       "{confidence_percent:g} % at least {sure_reduction_percent:.2f} %."},

      {unconfirmed_champion_withdrawn, "unconfirmed_champion_withdrawn", none,
       "Not confirmed: the champion that it was to replace was withdrawn; windows that end from "
       "now on are judged without one."},
      {unconfirmed_confirmation_off, "unconfirmed_confirmation_off", none,
       "Not confirmed: `confirmation` is 0 now, so that no version waits for telemetry after its "
       "window."},
      {unconfirmed_older, "unconfirmed_older", none,
       "Not confirmed: champion {champion:d} was identified from newer telemetry."},
      {unconfirmed_too_soon, "unconfirmed_too_soon", none,
       "Not confirmed: the window ends {since_ns:duration} after that of champion {champion:d}; "
       "versions are at least {min_interval_ns:duration} apart."},
      {unconfirmed_damaged, "unconfirmed_damaged", none,
       "Not confirmed: version {version:d} is damaged in the registry: {damage}."},
      {unconfirmed_other_outputs, "unconfirmed_other_outputs", none,
       "Not confirmed: champion {champion:d} has other outputs."},
      {unconfirmed_nothing_left, "unconfirmed_nothing_left", none,
       "Not confirmed: no telemetry to judge it by is left."},

      {unconfirmed_in_doubt, "unconfirmed_in_doubt", none,
       "Not confirmed: with {fault_percent:.2f} faults of sensors found in 100 ticks any "
       "comparison is doubtful."},
      {unconfirmed_above_limit, "unconfirmed_above_limit", none,
       "Not confirmed: that is above the limit of {max_mrse_percent:g} %."},
      {unconfirmed_nothing_after, "unconfirmed_nothing_after", none,
       "Not confirmed: of the telemetry after its window none is believed and says anything."},
      {unconfirmed_worse_after, "unconfirmed_worse_after", none,
       "Not confirmed: on the {rows:d} samples after its window alone it has {mrse_percent:.3f} % "
       "and the champion {champion_mrse_percent:.3f} %."},
      {unconfirmed_worse_with_window, "unconfirmed_worse_with_window", none,
       "Not confirmed: over all of its window and what came after it, it has {mrse_percent:.3f} % "
       "and the champion {champion_mrse_percent:.3f} %."},
      {unconfirmed_not_surely_less, "unconfirmed_not_surely_less", none,
       "Not confirmed: that is not {margin_percent:g} % less, and surely {needed_percent:g} %."},
      {unconfirmed_not_keeping_up, "unconfirmed_not_keeping_up", none,
       "Not confirmed: that is not {margin_percent:g} % less, and surely {needed_percent:g} %, as "
       "it has to be of a version that has {after_mrse_percent:.3f} % after its window and had "
       "{validated_mrse_percent:.3f} % where it was validated."},
      {unconfirmed_within_noise, "unconfirmed_within_noise", none,
       "Not confirmed: that is too little less beside the noise of the sensors "
       "({noise_percent:.3f} %)."},
      {unconfirmed_input_still, "unconfirmed_input_still", none,
       "Not confirmed: from the begin of its window on {input} stands still: it is stuck, or the "
       "operation is not the usual one."},
      {unconfirmed_unusual, "unconfirmed_unusual", none,
       "Not confirmed: there the inputs move over {movement_percent:.0f} % of the ranges that the "
       "champion was identified in: an unusual operation, which says little of the usual one."},
      {unconfirmed_no_change, "unconfirmed_no_change", none,
       "Not confirmed: the champion had {champion_validated_mrse_percent:.3f} % where it was "
       "validated, so that nothing tells of a change; over {rows:d} samples of then and now the "
       "version has {mrse_percent:.3f} % and the champion {champion_mrse_percent:.3f} %."},
      {unconfirmed_after_not_sure, "unconfirmed_after_not_sure", none,
       "Not confirmed: on the {rows:d} samples after its window alone it has {mrse_percent:.3f} % "
       "and the champion {champion_mrse_percent:.3f} %, which is not surely less."},
      {unconfirmed_tenure_excluded, "unconfirmed_tenure_excluded", none,
       "Not confirmed: the champion had {champion_validated_mrse_percent:.3f} % where it was "
       "validated, and of the telemetry that leads from then to the version's window "
       "{believed_percent:.0f} % is believed, so that nothing tells of a change."},
      {unconfirmed_as_in_tenure, "unconfirmed_as_in_tenure", none,
       "Not confirmed: since the champion was validated it had up to "
       "{champion_worst_mrse_percent:.3f} % already, so that nothing tells of a change; over "
       "{rows:d} samples of then and now the version has {mrse_percent:.3f} % and the champion "
       "{champion_mrse_percent:.3f} %."},
      {unconfirmed_excursion, "unconfirmed_excursion", none,
       "Not confirmed: but for a constant the champion has {without_offset_percent:.3f} %, and a "
       "mode with a time constant of {slowest_rows:.0f} samples may make it for a while; over "
       "{rows:d} samples since the champion was validated the version has {mrse_percent:.3f} % and "
       "the champion {champion_mrse_percent:.3f} %."},
  };
};

}  // namespace reident
