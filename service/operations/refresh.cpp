#include "service/operations/refresh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "service/model/model_json.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::RowRange;
using nlohmann::ordered_json;

ordered_json limits_json(const EquipmentConfig& limits, const Plausibility& checked) {
  return {{"max_mrse_percent", limits.max_mrse_percent},
          {"margin_percent", limits.margin_percent},
          {"confidence_percent", limits.confidence_percent},
          {"min_interval_ns", limits.min_interval},
          {"cycle_ns", limits.cycle},
          {"members", limits.members},
          {"regime_inputs", limits.regime_inputs},
          {"unbound", unbound_parameters(limits, checked.applied)},
          {"bias", limits.bias == BiasPolicy::wait ? "wait" : "approve"},
          {"approval", limits.approval == ApprovalPolicy::by_hand ? "by_hand" : "automatic"},
          {"on_failure", limits.on_failure == FailurePolicy::keep ? "keep" : "withdraw"},
          {"baseline_mrse_percent", limits.baseline_mrse_percent
                                        ? ordered_json(*limits.baseline_mrse_percent)
                                        : ordered_json()}};
}

/// The champion, where it can be read and is older than the window: one that was fitted to what is
/// to judge it gives no candidate.
std::optional<EquipmentModel> older_champion(const storage::Registry& registry,
                                             const PreparedWindow& prepared, std::int64_t& number) {
  const EquipmentModel& identified = prepared.candidate->model;
  const auto version = registry.champion(identified.spacecraft, identified.equipment);
  if (!version || mistake_in(*version)) return std::nullopt;
  number = version->number;
  EquipmentModel champion = equipment_model_from_json(version->model_json);
  if (champion.validated_on.begin > identified.validated_on.begin) return std::nullopt;
  return champion;
}

/// MRSE of the champion, as it is, on the validation part; not a number where it asks for other
/// telemetry.
double champion_error(const EquipmentModel& champion, const PreparedWindow& prepared) {
  const Candidate& candidate = *prepared.candidate;
  if (request_of(champion) != request_of(candidate.model))
    return std::numeric_limits<double>::quiet_NaN();
  const identification::Record& record = prepared.data.record;
  const RowRange rows = candidate.parts.validate;
  const auto validation = [&](const Matrix& samples) -> Matrix {
    return samples.middleRows(rows.begin, rows.size());
  };
  const Matrix run = free_run(champion.dynamics, record, record.all());
  return identification::score(validation(record.y), validation(run)).mrse();
}

/// Puts the champion, adapted to the window, in the candidate's place where it errs less on the
/// validation part, or where the candidate is too slow to be admissible.
std::optional<EquipmentModel> choose_candidate(const storage::Registry& registry,
                                               const RefreshRequest& request,
                                               PreparedWindow& prepared, std::int64_t& number) {
  auto champion = older_champion(registry, prepared, number);
  if (!champion) return champion;
  auto other = adapted_candidate(request, *champion, number, prepared);
  if (!other) return champion;
  const double identified = prepared.candidate->model.validation.mrse();
  const double adapted = other->model.validation.mrse();
  if (!std::isfinite(adapted)) return champion;
  const auto window_s = 1e-9 * static_cast<double>(request.window.end - request.window.begin);
  const bool is_better = adapted < identified ||
                         slowest_time_constant_s(prepared.candidate->model.dynamics) > window_s;
  prepared.evidence["adapted"] = {{"version", number},
                                  {"mrse_percent", adapted},
                                  {"identified_mrse_percent", identified},
                                  {"is_candidate", is_better}};
  if (is_better) prepared.candidate = std::move(other);
  return champion;
}

/// Puts a static gain in the candidate's place where it errs less on the validation part: no
/// dynamics that are worse than none reach a simulator.
void prefer_static_gain(const RefreshRequest& request, PreparedWindow& prepared) {
  Candidate other = static_candidate(request, prepared);
  const double dynamic = prepared.candidate->model.validation.mrse();
  const double error = other.model.validation.mrse();
  prepared.evidence["static_mrse_percent"] = error;
  if (error < dynamic) prepared.candidate = std::move(other);
}

/// The name of an output that keeps one value on the validation part; empty: none does.
std::string still_output(const PreparedWindow& prepared) {
  const RowRange rows = prepared.candidate->parts.validate;
  for (Index q = 0; q < prepared.data.record.y.cols(); ++q) {
    const auto y = prepared.data.record.y.col(q).segment(rows.begin, rows.size());
    if (y.maxCoeff() == y.minCoeff())
      return prepared.data.outputs[static_cast<std::size_t>(q)].name;
  }
  return {};
}

Evidence evidence_of(const PreparedWindow& prepared, const RefreshRequest& request) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  const Duration window =
      candidate.adapted_from ? request.equipment.window : request.window.end - request.window.begin;
  return {is_well_formed(model.dynamics),
          spectral_radius(model.dynamics),
          slowest_time_constant_s(model.dynamics) * 1e9 / static_cast<double>(window),
          model.validation.mrse(),
          model.validation.fit(),
          still_output(prepared)};
}

}  // namespace

RefreshResult judge(const storage::Registry& registry, const RefreshRequest& request,
                    PreparedWindow&& prepared) {
  RefreshResult result;
  if (prepared.candidate) {
    prepared.timer.begin("adapt");
    std::int64_t number = 0;
    const auto champion = choose_candidate(registry, request, prepared, number);
    prefer_static_gain(request, prepared);
    prepared.timer.begin("diagnose");
    describe_candidate(prepared);
    result.evidence = evidence_of(prepared, request);
    prepared.evidence["slowest_over_window"] = result.evidence.slowest_over_window;
    if (champion) result.champion_mrse_percent = champion_error(*champion, prepared);
    if (std::isfinite(result.champion_mrse_percent))
      prepared.evidence["champion_mrse_percent"] = result.champion_mrse_percent;
    prepared.evidence["limits"] = limits_json(request.equipment, prepared.data.plausibility);
    auto refusal = inadmissible(result.evidence, request.equipment);
    // One that errs no less than the champion would only take another's place in the league.
    if (!refusal && result.evidence.mrse_percent >= result.champion_mrse_percent)
      refusal = because<ReasonCode::not_better_where_validated>(
          result.evidence.mrse_percent, number, result.champion_mrse_percent);
    const std::vector<Reason> reasons = {
        refusal ? *refusal : because<ReasonCode::challenger>(result.evidence.mrse_percent)};
    const Outcome outcome = outcome_of(reasons);
    prepared.attempt.outcome = name(outcome);
    prepared.attempt.reason = sentences(reasons);
    prepared.evidence["reasons"] = to_json(reasons);
    result.decision = storage::NewDecision{kind_of(outcome), "gate", prepared.attempt.reason};
    if (result.decision->kind != storage::DecisionKind::reject) let_follow(prepared);
    result.version = version_of(request, prepared);
    result.candidate = std::move(prepared.candidate->model);
  }
  prepared.timer.end();
  for (const auto& [phase, milliseconds] : prepared.timer.phases())
    prepared.evidence["timing_ms"][phase] = milliseconds;
  result.attempt = std::move(prepared.attempt);
  result.attempt.evidence_json =
      prepared.evidence.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  return result;
}

storage::TimeRange behind_champion(const storage::Registry& registry, const std::string& spacecraft,
                                   const std::string& equipment, storage::TimeRange window) {
  const auto champion = registry.champion(spacecraft, equipment);
  if (champion && champion->window.end <= window.end)
    window.begin = std::max(window.begin, champion->window.begin);
  return window;
}

RefreshResult refresh(const storage::Archive& archive, const storage::Registry& registry,
                      const RefreshRequest& request, WindowCache& kept,
                      const identification::ForEach& for_each, const std::function<bool()>& stop) {
  return judge(registry, request, prepare_window(archive, request, kept, for_each, stop));
}

}  // namespace reident
