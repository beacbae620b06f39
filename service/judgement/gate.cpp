#include "service/judgement/gate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

using Refusal = std::optional<Reason>;
using Code = ReasonCode;

Refusal against_model(const Evidence& e) {
  if (!e.validation_moves) return because<Code::validation_says_nothing>();
  if (!e.well_formed || !std::isfinite(e.mrse_percent) || std::isnan(e.fit_percent))
    return because<Code::not_finite>();
  if (!(e.spectral_radius < 1.0)) return because<Code::unstable>(e.spectral_radius);
  if (e.slowest_over_window > slowest_limit)
    return because<Code::slower_than_window>(e.slowest_over_window);
  return std::nullopt;
}

Refusal against_scores(const Evidence& e, const EquipmentConfig& limits) {
  if (e.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(e.mrse_percent, limits.max_mrse_percent);
  if (!(e.fit_percent > 0) || e.fit_percent < limits.min_fit_percent)
    return because<Code::fit_below_limit>(e.fit_percent, limits.min_fit_percent);
  if (!e.mean.sure_percent) return because<Code::fit_of_few_samples>(e.fit_percent, e.mean.rows);
  if (!(*e.mean.sure_percent > 0))
    return because<Code::fit_not_sure>(e.fit_percent, limits.confidence_percent);
  if (!(e.residual_over_span <= residual_limit))
    return because<Code::residual_out_of_range>(e.residual_over_span);
  if (!(e.outside_share <= outside_limit))
    return because<Code::inputs_out_of_range>(100 * e.outside_share);
  return std::nullopt;
}

Refusal against_baseline(const Evidence& e, const EquipmentConfig& limits) {
  if (e.baseline) {
    if (!(e.baseline->sure_percent > limits.margin_percent))
      return because<Code::not_better_than_simulator>(
          e.baseline->mrse_percent, e.baseline->rival_mrse_percent, limits.margin_percent);
    return std::nullopt;
  }
  if (limits.baseline_mrse_percent && e.mrse_percent >= *limits.baseline_mrse_percent)
    return because<Code::not_below_baseline>(e.mrse_percent, *limits.baseline_mrse_percent);
  return std::nullopt;
}

bool has_run(const std::optional<Evidence::Champion>& champion) {
  return champion && champion->comparison &&
         std::isfinite(champion->comparison->rival_mrse_percent);
}

Refusal against_faults(const Evidence& e) {
  if (!is_in_doubt(e.fault_share)) return std::nullopt;
  return because<Code::telemetry_in_doubt>(100 * e.fault_share, e.champion->version);
}

Refusal against_comparison(const Evidence::Champion& champion, const EquipmentConfig& limits) {
  const Evidence::Comparison& comparison = *champion.comparison;
  if (!comparison.sure_percent)
    return because<Code::comparison_says_nothing>(comparison.rows, champion.version);
  if (!(*comparison.sure_percent > limits.margin_percent))
    return because<Code::not_surely_better>(comparison.mrse_percent, champion.version,
                                            comparison.rival_mrse_percent, limits.margin_percent,
                                            comparison.reduction_percent, *comparison.sure_percent,
                                            limits.confidence_percent);
  if (!shows_beside_noise(comparison, least_gain_over_noise))
    return because<Code::gain_within_noise>(comparison.mrse_percent, champion.version,
                                            comparison.rival_mrse_percent,
                                            comparison.noise_percent);
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
  return because<Code::disagrees_with_champion>(elsewhere.rows, champion.version,
                                                elsewhere.disagreement_percent,
                                                limits.max_disagreement_percent);
}

Refusal against_older(const Evidence& e) {
  if (e.window_end >= e.champion->window_end) return std::nullopt;
  return because<Code::older_than_champion>(e.champion->version);
}

Refusal against_succession(const Evidence& e, const EquipmentConfig& limits) {
  const Evidence::Champion& champion = *e.champion;
  if (auto refusal = against_elsewhere(champion, limits)) return refusal;
  const Duration since = e.window_end - champion.window_end;
  if (since < limits.min_interval)
    return because<Code::too_soon>(since, champion.version, limits.min_interval);
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

Reason wait_of(const EquipmentConfig& limits) {
  return because<Code::waits_for_telemetry>(limits.confirmation);
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

/// Nothing where nothing speaks against it.
std::vector<Reason> against_champion(const Evidence& e, const EquipmentConfig& limits) {
  const auto only = [](Refusal refusal) {
    return refusal ? std::vector{*std::move(refusal)} : std::vector<Reason>();
  };
  if (auto refusal = against_older(e)) return only(refusal);
  auto refusal = against_succession(e, limits);
  // A champion that cannot run here, or runs astray, loses to any candidate that holds the rest.
  if (!has_run(e.champion)) return only(refusal);
  if (auto doubt = against_faults(e)) return only(doubt);
  auto not_better = against_comparison(*e.champion, limits);
  if (!not_better) return only(refusal);
  if (!refusal && may_become_sure(e, limits)) return {*not_better, wait_of(limits)};
  return only(not_better);
}

Reason praise(const Evidence& e) {
  if (!e.champion) return because<Code::first_version>(e.mrse_percent, e.fit_percent);
  if (!e.champion->comparison)
    return because<Code::champion_cannot_run>(e.mrse_percent, e.champion->version);
  return because<Code::better_than_champion>(e.champion->comparison->mrse_percent,
                                             e.champion->version,
                                             e.champion->comparison->rival_mrse_percent);
}

/// What telemetry after the window had better tell first.
Refusal against_haste(const Evidence& e, const EquipmentConfig& limits) {
  if (!has_run(e.champion) || !may_wait(e, limits)) return std::nullopt;
  const Evidence::Champion& champion = *e.champion;
  if (gains_a_constant(champion, limits))
    return because<Code::offset_not_sure>(champion.without_offset->rival_mrse_percent,
                                          surely_needed_elsewhere(limits));
  if (!shows_beside_noise(*champion.comparison, plain_gain_over_noise))
    return because<Code::gain_near_noise>(champion.comparison->noise_percent);
  if (static_cast<double>(champion.comparison->rows) < champion.slowest_rows)
    return because<Code::shorter_than_slowest>(champion.slowest_rows);
  if (!champion.still.empty()) return because<Code::input_still>(champion.still);
  if (is_unusual(champion.movement))
    return because<Code::operation_unusual>(100 * champion.movement);
  if (!is_left_behind(champion.comparison->rival_mrse_percent, champion.validated_mrse_percent) &&
      !(champion.where_validated && champion.where_validated->sure_percent > limits.margin_percent))
    return because<Code::hardly_changed>(champion.validated_mrse_percent);
  return std::nullopt;
}

std::vector<Reason> reasons_of(const Evidence& evidence, const EquipmentConfig& limits) {
  if (auto refusal = against_model(evidence)) return {*refusal};
  if (auto refusal = against_scores(evidence, limits)) return {*refusal};
  if (evidence.champion)
    if (auto refusals = against_champion(evidence, limits); !refusals.empty()) return refusals;
  if (!has_run(evidence.champion))
    if (auto refusal = against_baseline(evidence, limits)) return {*refusal};
  if (evidence.hold)
    return {praise(evidence), because<Code::held>(evidence.hold->actor, evidence.hold->reason)};
  if (is_unvouched(evidence, limits))
    return {praise(evidence), because<Code::offset_unvouched>(
                                  limits.margin_percent,
                                  fmt::format("{}", fmt::join(evidence.champion->unbound, ", ")))};
  if (auto haste = against_haste(evidence, limits))
    return {praise(evidence), *haste, wait_of(limits)};
  if (limits.approval == ApprovalPolicy::by_hand)
    return {praise(evidence), because<Code::waits_for_operator>()};
  return {praise(evidence)};
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
  std::vector<Reason> reasons = reasons_of(evidence, limits);
  const Outcome outcome = outcome_of(reasons);
  return {outcome, std::move(reasons)};
}

}  // namespace reident
