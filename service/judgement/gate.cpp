#include "service/judgement/gate.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "service/support/time_text.hpp"

namespace reident {
namespace {

/// An error larger than the output's own range means that the run left the plant's world, even
/// where the mean error still looks fair.
constexpr double residual_limit = 1.0;

/// Where the inputs are elsewhere on most rows, the scores say nothing of what was identified.
constexpr double outside_limit = 0.5;

/// A time constant of more windows than this is an integrator as far as the window can tell: what
/// little drives it adds up.
constexpr double slowest_limit = 1.0;

/// Honest telemetry has at most 1 find in 1000 ticks (tests/trust).
constexpr double fault_limit = 1.0 / 400;

/// Without its payload a spacecraft moves the inputs of its equipment over 0.54 and more of what it
/// else does, in safe mode over 0.2 to 0.52 (tests/trust).
constexpr double least_movement = 0.53;

constexpr double left_behind_factor = 1.5;

double without_noise(double mrse_percent, double noise_percent) {
  return std::sqrt(std::max(0.0, mrse_percent * mrse_percent - noise_percent * noise_percent));
}

using Refusal = std::optional<GateDecision>;

Refusal against_model(const Evidence& e) {
  if (!e.validation_moves)
    return GateDecision{Outcome::validation_says_nothing,
                        "An output does not move in the validation part, so that no score there "
                        "can tell a good model from a bad one."};
  if (!e.well_formed || !std::isfinite(e.mrse_percent) || std::isnan(e.fit_percent))
    return GateDecision{Outcome::not_finite,
                        "The model or its run holds numbers that are not finite."};
  if (!(e.spectral_radius < 1.0))
    return GateDecision{
        Outcome::unstable,
        fmt::format("The model is unstable: its spectral radius is {:.6f}.", e.spectral_radius)};
  if (e.slowest_over_window > slowest_limit)
    return GateDecision{
        Outcome::slower_than_window,
        fmt::format("Its slowest time constant is {:.3g} times the window's length, which cannot "
                    "tell it: a long run would drift away.",
                    e.slowest_over_window)};
  return std::nullopt;
}

Refusal against_scores(const Evidence& e, const EquipmentConfig& limits) {
  if (e.mrse_percent > limits.max_mrse_percent)
    return GateDecision{Outcome::error_above_limit,
                        fmt::format("MRSE {:.3f} % on unseen data is above the limit of {:g} %.",
                                    e.mrse_percent, limits.max_mrse_percent)};
  if (!(e.fit_percent > 0) || e.fit_percent < limits.min_fit_percent)
    return GateDecision{Outcome::fit_below_limit,
                        fmt::format("Fit {:.2f} % on unseen data is below the limit of {:g} % "
                                    "(0 % is a constant at the mean).",
                                    e.fit_percent, limits.min_fit_percent)};
  if (!e.mean.sure_percent)
    return GateDecision{
        Outcome::fit_below_limit,
        fmt::format(
            "Fit {:.2f} % on {} unseen samples may be chance: they are too few, or too much "
            "of one stretch, to tell.",
            e.fit_percent, e.mean.rows)};
  if (!(*e.mean.sure_percent > 0))
    return GateDecision{
        Outcome::fit_below_limit,
        fmt::format("Fit {:.2f} % on unseen data may be chance: with a confidence of {:g} % it is "
                    "not above 0 % (a constant at the mean).",
                    e.fit_percent, limits.confidence_percent)};
  if (!(e.residual_over_span <= residual_limit))
    return GateDecision{
        Outcome::residual_out_of_range,
        fmt::format("The largest error is {:.2f} times the output's range.", e.residual_over_span)};
  if (!(e.outside_share <= outside_limit))
    return GateDecision{
        Outcome::inputs_out_of_range,
        fmt::format("On {:.0f} % of the validation part an input is outside the range that the "
                    "model was identified in: the score there is of an extrapolation.",
                    100 * e.outside_share)};
  return std::nullopt;
}

Refusal against_baseline(const Evidence& e, const EquipmentConfig& limits) {
  if (e.baseline) {
    if (!(e.baseline->sure_percent > limits.margin_percent))
      return GateDecision{
          Outcome::not_better_than_baseline,
          fmt::format("MRSE {:.3f} % does not surely undercut the simulator's own telemetry "
                      "({:.3f} % on the same samples) by {:g} %.",
                      e.baseline->mrse_percent, e.baseline->rival_mrse_percent,
                      limits.margin_percent)};
    return std::nullopt;
  }
  if (limits.baseline_mrse_percent && e.mrse_percent >= *limits.baseline_mrse_percent)
    return GateDecision{Outcome::not_better_than_baseline,
                        fmt::format("MRSE {:.3f} % is not below the baseline's {:.3f} %.",
                                    e.mrse_percent, *limits.baseline_mrse_percent)};
  return std::nullopt;
}

bool has_run(const std::optional<Evidence::Champion>& champion) {
  return champion && champion->comparison &&
         std::isfinite(champion->comparison->rival_mrse_percent);
}

Refusal against_faults(const Evidence& e) {
  if (!is_in_doubt(e.fault_share)) return std::nullopt;
  return GateDecision{
      Outcome::telemetry_in_doubt,
      fmt::format("{:.2f} faults of sensors were found in 100 ticks: others that go unnoticed "
                  "make any comparison doubtful, and champion {} stays.",
                  100 * e.fault_share, e.champion->version)};
}

Refusal against_comparison(const Evidence::Champion& champion, const EquipmentConfig& limits) {
  const Evidence::Comparison& comparison = *champion.comparison;
  if (!comparison.sure_percent)
    return GateDecision{
        Outcome::comparison_says_nothing,
        fmt::format("{} samples compare the candidate with champion {}: too few, or too much of "
                    "one stretch, to tell.",
                    comparison.rows, champion.version)};
  if (!(*comparison.sure_percent > limits.margin_percent))
    return GateDecision{
        Outcome::not_better_than_champion,
        fmt::format("MRSE {:.3f} % does not surely undercut champion {} ({:.3f} % on the same "
                    "samples) by {:g} %: the reduction is {:.2f} %, and {:.2f} % with a "
                    "confidence of {:g} %.",
                    comparison.mrse_percent, champion.version, comparison.rival_mrse_percent,
                    limits.margin_percent, comparison.reduction_percent, *comparison.sure_percent,
                    limits.confidence_percent)};
  if (!shows_beside_noise(comparison, least_gain_over_noise))
    return GateDecision{
        Outcome::not_better_than_champion,
        fmt::format("MRSE {:.3f} % undercuts champion {} ({:.3f} % on the same samples) by too "
                    "little beside the noise of the sensors ({:.3f} %).",
                    comparison.mrse_percent, champion.version, comparison.rival_mrse_percent,
                    comparison.noise_percent)};
  return std::nullopt;
}

/// Whether all that the candidate surely gains is a constant. A stretch in which the champion is
/// off by one may be one of an unusual operation.
bool gains_a_constant(const Evidence::Champion& champion, const EquipmentConfig& limits) {
  return champion.without_offset &&
         !(champion.without_offset->sure_percent > surely_needed_elsewhere(limits));
}

/// Where the equipment has changed from one model to another, the new one errs on the past about as
/// much as the old one errs now; where it has changed by a constant, the two differ on the past by
/// the old one's mean error of now. Where the operation has changed for a while, the new one errs
/// on the past by anything, so by that too: what gains a constant alone goes on probation.
bool explains(const Evidence::Champion& champion, const Evidence::Champion::Elsewhere& elsewhere,
              const EquipmentConfig& limits) {
  if (!has_run(champion)) return false;
  return (limits.confirmation > 0 &&
          elsewhere.without_offset_percent <= limits.max_disagreement_percent) ||
         (!gains_a_constant(champion, limits) &&
          elsewhere.mrse_percent <= champion.comparison->rival_mrse_percent);
}

Refusal against_elsewhere(const Evidence::Champion& champion, const EquipmentConfig& limits) {
  if (!champion.elsewhere) return std::nullopt;
  const Evidence::Champion::Elsewhere& elsewhere = *champion.elsewhere;
  if (elsewhere.disagreement_percent <= limits.max_disagreement_percent ||
      elsewhere.mrse_percent < elsewhere.champion_mrse_percent ||
      explains(champion, elsewhere, limits))
    return std::nullopt;
  return GateDecision{
      Outcome::disagrees_with_champion,
      fmt::format("On {} samples of the window of champion {}, with inputs that this one was not "
                  "validated with, the two differ by {:.1f} % of the output's range, above the "
                  "limit of {:g} %, and the champion is nearer to the telemetry of that time.",
                  elsewhere.rows, champion.version, elsewhere.disagreement_percent,
                  limits.max_disagreement_percent)};
}

Refusal against_older(const Evidence& e) {
  if (e.window_end >= e.champion->window_end) return std::nullopt;
  return GateDecision{
      Outcome::older_than_champion,
      fmt::format("Champion {} was identified from newer telemetry.", e.champion->version)};
}

Refusal against_succession(const Evidence& e, const EquipmentConfig& limits) {
  const Evidence::Champion& champion = *e.champion;
  if (auto refusal = against_elsewhere(champion, limits)) return refusal;
  const Duration since = e.window_end - champion.window_end;
  if (since < limits.min_interval)
    return GateDecision{
        Outcome::too_soon,
        fmt::format("The window ends {} after that of champion {}; versions are at "
                    "least {} apart.",
                    duration_text(since), champion.version, duration_text(limits.min_interval))};
  return std::nullopt;
}

/// A sensor that went off by a constant and an equipment that did are the same telemetry, unless
/// another sensor vouches for the first: then the candidate has to be better without that.
bool needs_vouching(const Evidence::Champion& champion, const EquipmentConfig& limits) {
  return limits.unvouched == UnvouchedPolicy::wait && !champion.unbound.empty() &&
         champion.without_offset;
}

bool is_unvouched(const Evidence& e, const EquipmentConfig& limits) {
  if (!has_run(e.champion) || !needs_vouching(*e.champion, limits)) return false;
  const auto& sure = e.champion->without_offset->sure_percent;
  return !sure || !(*sure > limits.margin_percent);
}

/// Whether telemetry after the window may decide.
bool may_wait(const Evidence& e, const EquipmentConfig& limits) {
  return limits.confirmation > 0 && limits.approval == ApprovalPolicy::automatic && !e.hold;
}

std::string wait_of(const EquipmentConfig& limits) {
  return fmt::format(" Waits for {} of telemetry after its window, or for twice as much.",
                     duration_text(limits.confirmation));
}

/// Better by the margin, and not surely.
bool may_become_sure(const Evidence& e, const EquipmentConfig& limits) {
  const Evidence::Champion& champion = *e.champion;
  if (!may_wait(e, limits) || !champion.comparison->sure_percent) return false;
  double reduction = champion.comparison->reduction_percent;
  if (needs_vouching(champion, limits))
    reduction = std::min(reduction, champion.without_offset->reduction_percent);
  return reduction > limits.margin_percent;
}

Refusal against_champion(const Evidence& e, const EquipmentConfig& limits) {
  if (auto refusal = against_older(e)) return refusal;
  auto refusal = against_succession(e, limits);
  // A champion that cannot run here, or runs astray, loses to any candidate that holds the rest.
  if (!has_run(e.champion)) return refusal;
  if (auto doubt = against_faults(e)) return doubt;
  auto not_better = against_comparison(*e.champion, limits);
  if (!not_better) return refusal;
  if (!refusal && may_become_sure(e, limits)) {
    not_better->outcome = Outcome::on_probation;
    not_better->reason += wait_of(limits);
  }
  return not_better;
}

std::string praise(const Evidence& e) {
  if (!e.champion)
    return fmt::format("First version: MRSE {:.3f} %, fit {:.1f} % on unseen data.", e.mrse_percent,
                       e.fit_percent);
  if (!e.champion->comparison)
    return fmt::format("MRSE {:.3f} % on unseen data, on which champion {} cannot run.",
                       e.mrse_percent, e.champion->version);
  return fmt::format("MRSE {:.3f} % on unseen data; champion {} has {:.3f} % on the same samples.",
                     e.champion->comparison->mrse_percent, e.champion->version,
                     e.champion->comparison->rival_mrse_percent);
}

/// What telemetry after the window had better tell first.
Refusal against_haste(const Evidence& e, const EquipmentConfig& limits) {
  if (!has_run(e.champion) || !may_wait(e, limits)) return std::nullopt;
  const Evidence::Champion& champion = *e.champion;
  if (gains_a_constant(champion, limits))
    return GateDecision{
        Outcome::on_probation,
        praise(e) +
            fmt::format(" But for a constant offset the champion has {:.3f} %, which is not "
                        "surely worse by {:g} %.",
                        champion.without_offset->rival_mrse_percent,
                        surely_needed_elsewhere(limits)) +
            wait_of(limits)};
  if (!shows_beside_noise(*champion.comparison, plain_gain_over_noise))
    return GateDecision{
        Outcome::on_probation,
        praise(e) +
            fmt::format(" That is little less beside the noise of the sensors ({:.3f} %).",
                        champion.comparison->noise_percent) +
            wait_of(limits)};
  if (static_cast<double>(champion.comparison->rows) < champion.slowest_rows)
    return GateDecision{Outcome::on_probation,
                        praise(e) +
                            fmt::format(" But those are fewer than the slowest time constant of "
                                        "the two lasts ({:.0f}).",
                                        champion.slowest_rows) +
                            wait_of(limits)};
  if (!champion.still.empty())
    return GateDecision{Outcome::on_probation,
                        praise(e) +
                            fmt::format(" But {} stands still all over the window: it is stuck, "
                                        "or the operation is not the usual one.",
                                        champion.still) +
                            wait_of(limits)};
  if (is_unusual(champion.movement))
    return GateDecision{
        Outcome::on_probation,
        praise(e) +
            fmt::format(" The inputs move over {:.0f} % of the ranges that the champion was "
                        "identified in: the operation is not the usual one.",
                        100 * champion.movement) +
            wait_of(limits)};
  if (!is_left_behind(champion.comparison->rival_mrse_percent, champion.validated_mrse_percent) &&
      !(champion.where_validated && champion.where_validated->sure_percent > limits.margin_percent))
    return GateDecision{
        Outcome::on_probation,
        praise(e) +
            fmt::format(" It had {:.3f} % where it was validated, so that the equipment has hardly "
                        "changed.",
                        champion.validated_mrse_percent) +
            wait_of(limits)};
  return std::nullopt;
}

}  // namespace

double surely_needed_elsewhere(const EquipmentConfig& limits) {
  return limits.margin_percent / 3;
}

bool shows_beside_noise(const Evidence::Comparison& comparison, double times) {
  const double noise = comparison.noise_percent;
  return !(without_noise(comparison.rival_mrse_percent, noise) -
               without_noise(comparison.mrse_percent, noise) <=
           times * noise);
}

bool is_in_doubt(double fault_share) {
  return fault_share > fault_limit;
}

bool is_unusual(double movement) {
  return movement < least_movement;
}

bool is_left_behind(double mrse_percent, double validated_mrse_percent) {
  return !(mrse_percent < left_behind_factor * validated_mrse_percent);
}

GateDecision decide(const Evidence& evidence, const EquipmentConfig& limits) {
  if (auto refusal = against_model(evidence)) return *refusal;
  if (auto refusal = against_scores(evidence, limits)) return *refusal;
  if (evidence.champion)
    if (auto refusal = against_champion(evidence, limits)) return *refusal;
  if (!has_run(evidence.champion))
    if (auto refusal = against_baseline(evidence, limits)) return *refusal;
  if (evidence.hold)
    return {Outcome::held,
            praise(evidence) + fmt::format(" Waits: {} holds the equipment ({}).",
                                           evidence.hold->actor, evidence.hold->reason)};
  if (is_unvouched(evidence, limits))
    return {
        Outcome::unvouched,
        praise(evidence) +
            fmt::format(" But for a constant offset the champion is not surely worse by {:g} %, "
                        "and a sensor of {} would show the same; no relation binds it. Waits "
                        "for an operator's approval.",
                        limits.margin_percent, fmt::join(evidence.champion->unbound, ", "))};
  if (auto haste = against_haste(evidence, limits)) return *haste;
  if (limits.approval == ApprovalPolicy::by_hand)
    return {Outcome::waiting, praise(evidence) + " Waits for an operator's approval."};
  return {Outcome::approved, praise(evidence)};
}

}  // namespace reident
