#include "service/daemon/gate.hpp"

#include <cmath>

#include <fmt/format.h>

namespace reident {
namespace {

/// An error larger than the output's own range means that the run left the plant's world, even
/// where the mean error still looks fair.
constexpr double residual_limit = 1.0;

std::optional<GateDecision> against_candidate(const Evidence& e, const EquipmentConfig& limits) {
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
  if (e.mrse_percent > limits.max_mrse_percent)
    return GateDecision{Outcome::error_above_limit,
                        fmt::format("MRSE {:.3f} % on unseen data is above the limit of {:g} %.",
                                    e.mrse_percent, limits.max_mrse_percent)};
  if (!(e.fit_percent > 0) || e.fit_percent < limits.min_fit_percent)
    return GateDecision{Outcome::fit_below_limit,
                        fmt::format("Fit {:.2f} % on unseen data is below the limit of {:g} % "
                                    "(0 % is a constant at the mean).",
                                    e.fit_percent, limits.min_fit_percent)};
  if (!(e.residual_over_span <= residual_limit))
    return GateDecision{
        Outcome::residual_out_of_range,
        fmt::format("The largest error is {:.2f} times the output's range.", e.residual_over_span)};
  return std::nullopt;
}

std::optional<GateDecision> against_incumbent(const Evidence& e, const EquipmentConfig& limits) {
  if (!e.champion) {
    if (limits.baseline_mrse_percent && e.mrse_percent >= *limits.baseline_mrse_percent)
      return GateDecision{Outcome::not_better_than_baseline,
                          fmt::format("MRSE {:.3f} % is not below the baseline's {:.3f} %.",
                                      e.mrse_percent, *limits.baseline_mrse_percent)};
    return std::nullopt;
  }
  const Evidence::Champion& champion = *e.champion;
  if (e.window_end < champion.window_end)
    return GateDecision{
        Outcome::older_than_champion,
        fmt::format("Champion {} was identified from newer telemetry.", champion.version)};
  const double needed = champion.mrse_percent * (1 - limits.margin_percent / 100);
  if (std::isfinite(champion.mrse_percent) && !(e.mrse_percent < needed))
    return GateDecision{
        Outcome::not_better_than_champion,
        fmt::format("MRSE {:.3f} % does not undercut champion {} ({:.3f} % on the same samples) "
                    "by {:g} %.",
                    e.mrse_percent, champion.version, champion.mrse_percent,
                    limits.margin_percent)};
  return std::nullopt;
}

std::string praise(const Evidence& e) {
  if (!e.champion)
    return fmt::format("First version: MRSE {:.3f} %, fit {:.1f} % on unseen data.", e.mrse_percent,
                       e.fit_percent);
  return fmt::format("MRSE {:.3f} % on unseen data; champion {} has {:.3f} % on the same samples.",
                     e.mrse_percent, e.champion->version, e.champion->mrse_percent);
}

}  // namespace

std::string_view name(Outcome outcome) {
  switch (outcome) {
    case Outcome::approved:
      return "approved";
    case Outcome::waiting:
      return "waiting";
    case Outcome::unknown_parameter:
      return "unknown_parameter";
    case Outcome::low_coverage:
      return "low_coverage";
    case Outcome::validation_says_nothing:
      return "validation_says_nothing";
    case Outcome::not_finite:
      return "not_finite";
    case Outcome::unstable:
      return "unstable";
    case Outcome::error_above_limit:
      return "error_above_limit";
    case Outcome::fit_below_limit:
      return "fit_below_limit";
    case Outcome::residual_out_of_range:
      return "residual_out_of_range";
    case Outcome::not_better_than_baseline:
      return "not_better_than_baseline";
    case Outcome::not_better_than_champion:
      return "not_better_than_champion";
    case Outcome::older_than_champion:
      return "older_than_champion";
  }
  return "unknown";
}

GateDecision decide(const Evidence& evidence, const EquipmentConfig& limits) {
  if (auto refusal = against_candidate(evidence, limits)) return *refusal;
  if (auto refusal = against_incumbent(evidence, limits)) return *refusal;
  if (limits.approval == ApprovalPolicy::by_hand)
    return {Outcome::waiting, praise(evidence) + " Waits for an operator's approval."};
  return {Outcome::approved, praise(evidence)};
}

}  // namespace reident
