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
  challenger,         // telemetry that it was not fitted to decides
  unknown_parameter,  // telemetry has not described a parameter of the equipment yet
  telemetry_damaged,  // samples that the attempt needs cannot be decoded any more
  low_coverage,
  implausible,  // sensors contradict each other, or themselves, on too much of the window
  not_finite,
  still_validation,
  unstable,
  slower_than_window,  // a time constant that looks like an integrator's over the window
  error_above_limit,
  not_better_than_mean,
  not_better_than_champion,
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
  // R4, of a candidate on its validation part and of a member on its record.
  not_finite,
  still_validation,
  unstable,
  slower_than_window,
  error_above_limit,
  not_better_than_mean,
  not_better_than_simulator,
  // A candidate enters the league, or would only take another's place.
  challenger,
  not_better_where_validated,
  too_few_blocks,
  // A member of the league becomes champion.
  first_version,
  better,
  // It does not: the first condition that its record does not meet.
  not_compared,         // R1
  not_better,           // R1
  within_margin,        // R1
  not_covered,          // R2
  worse_in_regime,      // R2
  worse_over_regimes,   // R2
  worse_before_change,  // R2
  bias_unverified,      // R3
  too_soon,             // R5
  held,                 // R5
  waits_for_operator,   // R5
  // It leaves the league.
  league_full,
  // The champion.
  champion_failed,
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
      {O::challenger, "challenger", wait},
      {O::unknown_parameter, "unknown_parameter", none},
      {O::telemetry_damaged, "telemetry_damaged", none},
      {O::low_coverage, "low_coverage", none},
      {O::implausible, "implausible", none},
      {O::not_finite, "not_finite", reject},
      {O::still_validation, "still_validation", reject},
      {O::unstable, "unstable", reject},
      {O::slower_than_window, "slower_than_window", reject},
      {O::error_above_limit, "error_above_limit", reject},
      {O::not_better_than_mean, "not_better_than_mean", reject},
      {O::not_better_than_champion, "not_better_than_champion", reject},
  };

  static constexpr ReasonRow reasons[] = {
      {unknown_parameter, "unknown_parameter", O::unknown_parameter,
       "Parameter {parameter} has not been described by telemetry yet; check its name in the "
       "configuration or wait for its descriptor."},
      {telemetry_damaged, "telemetry_damaged", O::telemetry_damaged, "{damage}"},
      {low_coverage, "low_coverage", O::low_coverage,
       "Only {coverage_percent:.1f} % of the window has every parameter valid; "
       "{min_coverage_percent:g} % are needed. {parameter} alone has a value in "
       "{parameter_coverage_percent:.1f} %."},
      {low_coverage_with_derived, "low_coverage_with_derived", O::low_coverage,
       "Only {coverage_percent:.1f} % of the window has every parameter valid and every derived "
       "input finite; {min_coverage_percent:g} % are needed. {parameter} alone has a value in "
       "{parameter_coverage_percent:.1f} %."},
      {implausible, "implausible", O::implausible,
       "Telemetry is not believed: {worst}. {coverage_percent:.1f} % of the window is left, "
       "{min_coverage_percent:g} % are needed."},
      {no_model, "no_model", none, "{verdict}"},

      {not_finite, "not_finite", O::not_finite,
       "The model or its run holds numbers that are not finite."},
      {still_validation, "still_validation", O::still_validation,
       "{output} does not move in the validation part, which says nothing about the model then."},
      {unstable, "unstable", O::unstable,
       "The model is unstable: its spectral radius is {spectral_radius:.6f}."},
      {slower_than_window, "slower_than_window", O::slower_than_window,
       "Its slowest time constant is {slowest_over_window:.3g} times the window's length, which "
       "cannot tell it: a long run would drift away."},
      {error_above_limit, "error_above_limit", O::error_above_limit,
       "MRSE {mrse_percent:.3f} % on telemetry that it was not fitted to is above the limit of "
       "{max_mrse_percent:g} %."},
      {not_better_than_mean, "not_better_than_mean", O::not_better_than_mean,
       "Fit {fit_percent:.2f} % on telemetry that it was not fitted to: an output's error is not "
       "below that of a constant at its mean (0 %)."},
      {not_better_than_simulator, "not_better_than_simulator", none,
       "MRSE {mrse_percent:.3f} % is not shown to be below that of the simulator's own model "
       "({baseline_mrse_percent:.3f} %)."},

      {challenger, "challenger", O::challenger,
       "A challenger with MRSE {mrse_percent:.3f} % on its validation part: that and the telemetry "
       "after its window decide."},
      {not_better_where_validated, "not_better_where_validated", O::not_better_than_champion,
       "MRSE {mrse_percent:.3f} % on its validation part, where champion {champion:d} has "
       "{champion_mrse_percent:.3f} %."},

      {too_few_blocks, "too_few_blocks", none,
       "{blocks:d} blocks of telemetry that it was not fitted to; a first version needs a whole "
       "cycle, {needed:d}."},
      {first_version, "first_version", none,
       "The first version: MRSE {mrse_percent:.3f} %, fit {fit_percent:.1f} % on {blocks:d} blocks "
       "of telemetry that it was not fitted to."},
      {better, "better", none,
       "MRSE {mrse_percent:.3f} % on {blocks:d} blocks of telemetry that it was not fitted to; "
       "champion {champion:d} has {champion_mrse_percent:.3f} % there. The mean score is "
       "{mean_score:.3f}, and at least {lower_score:.3f} with a confidence of "
       "{confidence_percent:g} %."},

      {not_compared, "not_compared", none,
       "Not compared with champion {champion:d} yet: no block since the last change of the "
       "equipment has an error of both."},
      {not_better, "not_better", none,
       "Not shown to be better than champion {champion:d}: MRSE {mrse_percent:.3f} % and "
       "{champion_mrse_percent:.3f} % on {blocks:d} blocks, log of the evidence {log_wealth:.2f} "
       "of "
       "{log_threshold:.2f}."},
      {within_margin, "within_margin", none,
       "Does not err less than champion {champion:d} by the margin of {margin_percent:g} %: MRSE "
       "{mrse_percent:.3f} % and {champion_mrse_percent:.3f} % on {blocks:d} blocks."},
      {not_covered, "not_covered", none,
       "Cannot replace champion {champion:d} yet: it has not met the operating regimes of "
       "{uncovered_percent:.0f} % of the time since the last change of the equipment."},
      {worse_in_regime, "worse_in_regime", none,
       "Worse than champion {champion:d}, with confidence, in an operating regime that this one "
       "has served."},
      {worse_over_regimes, "worse_over_regimes", none,
       "Over the operating regimes since the last change of the equipment, each with its share of "
       "the time, it errs no less than champion {champion:d}: MRSE {mrse_percent:.3f} % and "
       "{champion_mrse_percent:.3f} %."},
      {worse_before_change, "worse_before_change", none,
       "Before the last change of the equipment it errs {mrse_percent:.3f} %, more than twice what "
       "champion {champion:d} errs there or since, or another version there and since together: "
       "{champion_mrse_percent:.3f} %."},
      {bias_unverified, "bias_unverified", none,
       "Better than champion {champion:d} but for what a biased sensor of {sensors} would show "
       "too; no relation binds it. Waits for an operator's approval."},
      {too_soon, "too_soon", none,
       "The window ends {since_ns:duration} after that of champion {champion:d}; versions are at "
       "least {min_interval_ns:duration} apart."},
      {held, "held", none, "Better; waits: {actor} holds the equipment ({reason})."},
      {waits_for_operator, "waits_for_operator", none,
       "Better, with MRSE {mrse_percent:.3f} % on {blocks:d} blocks that it was not fitted to. "
       "Waits for an operator's approval."},

      {league_full, "league_full", none,
       "The league has {members:d} challengers that score better or wait for an operator."},

      {champion_failed, "champion_failed", none,
       "Champion {champion:d} has MRSE {mrse_percent:.3f} % on {blocks:d} blocks, where "
       "{rival} has less: {rival_mrse_percent:.3f} %."},
  };
};

}  // namespace reident
