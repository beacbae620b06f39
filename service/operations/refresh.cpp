#include "service/operations/refresh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "service/judgement/rivals.hpp"
#include "service/judgement/run_comparison.hpp"
#include "service/model/model_json.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::RowRange;
using nlohmann::ordered_json;

double residual_over_span(const Matrix& y, const Matrix& y_hat, const Matrix& window_y) {
  double worst = 0;
  for (Index q = 0; q < y.cols(); ++q) {
    const double span = window_y.col(q).maxCoeff() - window_y.col(q).minCoeff();
    const double error = (y.col(q) - y_hat.col(q)).cwiseAbs().maxCoeff();
    worst = std::max(worst, error / span);
  }
  return worst;
}

bool every_column_moves(const Matrix& samples) {
  return (samples.colwise().maxCoeff().array() > samples.colwise().minCoeff().array()).all();
}

double outside_share(const Matrix& u, const std::vector<Signal>& inputs) {
  const std::vector<Index> outside = rows_outside(u, inputs);
  return static_cast<double>(outside.size()) / static_cast<double>(u.rows());
}

double slowest_over_window(const identification::StateSpaceModel& model, Duration window) {
  return slowest_time_constant_s(model) * 1e9 / static_cast<double>(window);
}

Evidence evidence_of(const storage::Archive& archive, const storage::Registry& registry,
                     const RefreshRequest& request, const PreparedWindow& prepared,
                     double confidence) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  const RowRange rows = candidate.parts.validate;
  const auto validation = [rows](const Matrix& samples) -> Matrix {
    return samples.middleRows(rows.begin, rows.size());
  };
  const identification::Record& record = prepared.data.record;
  Evidence evidence;
  evidence.well_formed = is_well_formed(model.dynamics);
  evidence.spectral_radius = spectral_radius(model.dynamics);
  evidence.slowest_over_window = slowest_over_window(
      model.dynamics, candidate.adapted_from ? request.equipment.window
                                             : request.window.end - request.window.begin);
  evidence.validation_moves = every_column_moves(validation(record.y));
  evidence.mrse_percent = model.validation.mrse();
  evidence.fit_percent = model.validation.fit();
  evidence.residual_over_span =
      residual_over_span(validation(record.y), validation(candidate.y_hat), record.y);
  evidence.outside_share = outside_share(validation(record.u), model.inputs);
  evidence.fault_share = fault_share(prepared.data.plausibility,
                                     ticks_of(request.window, request.equipment.sample_period));
  evidence.window_end = request.window.end;
  evidence.mean = against_mean(prepared, confidence);
  evidence.champion =
      against_champion(archive, registry, prepared, confidence, request.equipment.margin_percent);
  evidence.baseline = against_simulator(archive, prepared, confidence);
  if (const auto hold = registry.hold(request.spacecraft, request.equipment.name))
    evidence.hold = Evidence::Hold{hold->actor, hold->reason};
  return evidence;
}

ordered_json to_json(const Evidence::Champion& champion) {
  ordered_json json = {{"version", champion.version}};
  if (champion.comparison) {
    json["mrse_percent"] = champion.comparison->rival_mrse_percent;
    json["validated_mrse_percent"] = champion.validated_mrse_percent;
    json["slowest_rows"] = champion.slowest_rows;
    json["movement"] = champion.movement;
    if (!champion.still.empty()) json["still"] = champion.still;
    json["comparison"] = to_json(*champion.comparison);
    if (champion.where_validated) json["where_validated"] = to_json(*champion.where_validated);
    if (champion.without_offset) json["without_offset"] = to_json(*champion.without_offset);
    if (!champion.unbound.empty()) json["unbound"] = champion.unbound;
  }
  if (const auto& elsewhere = champion.elsewhere)
    json["elsewhere"] = {{"rows", elsewhere->rows},
                         {"disagreement_percent", elsewhere->disagreement_percent},
                         {"without_offset_percent", elsewhere->without_offset_percent},
                         {"mrse_percent", elsewhere->mrse_percent},
                         {"champion_mrse_percent", elsewhere->champion_mrse_percent}};
  return json;
}

ordered_json limits_json(const EquipmentConfig& limits) {
  return {{"max_mrse_percent", limits.max_mrse_percent},
          {"min_fit_percent", limits.min_fit_percent},
          {"margin_percent", limits.margin_percent},
          {"confidence_percent", limits.confidence_percent},
          {"max_disagreement_percent", limits.max_disagreement_percent},
          {"min_interval_ns", limits.min_interval},
          {"confirmation_ns", limits.confirmation},
          {"unvouched", limits.unvouched == UnvouchedPolicy::wait ? "wait" : "approve"},
          {"approval", limits.approval == ApprovalPolicy::by_hand ? "by_hand" : "automatic"}};
}

void describe(const Evidence& evidence, ordered_json& json) {
  json["slowest_over_window"] = evidence.slowest_over_window;
  json["residual_over_span"] = evidence.residual_over_span;
  json["outside_share"] = evidence.outside_share;
  json["fault_share"] = evidence.fault_share;
  json["mean"] = to_json(evidence.mean);
  if (evidence.baseline) json["baseline"] = to_json(*evidence.baseline);
  if (evidence.champion) json["champion"] = to_json(*evidence.champion);
  if (evidence.hold)
    json["hold"] = {{"actor", evidence.hold->actor}, {"reason", evidence.hold->reason}};
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

/// Puts the champion, adapted to the window, in the candidate's place where it errs less on the
/// validation part, or where the candidate is too slow for the gate. How many candidates were
/// compared there.
int choose_candidate(const storage::Registry& registry, const RefreshRequest& request,
                     PreparedWindow& prepared) {
  std::int64_t number = 0;
  const auto champion = older_champion(registry, prepared, number);
  if (!champion) return 1;
  auto other = adapted_candidate(request, *champion, number, prepared);
  if (!other) return 1;
  const double identified = prepared.candidate->model.validation.mrse();
  const double adapted = other->model.validation.mrse();
  if (!std::isfinite(adapted)) return 1;
  const auto window_s = 1e-9 * static_cast<double>(request.window.end - request.window.begin);
  const bool is_better = adapted < identified ||
                         slowest_time_constant_s(prepared.candidate->model.dynamics) > window_s;
  prepared.evidence["adapted"] = {{"version", number},
                                  {"mrse_percent", adapted},
                                  {"identified_mrse_percent", identified},
                                  {"is_candidate", is_better}};
  if (is_better) prepared.candidate = std::move(other);
  return 2;
}

/// The confidence of each comparison, so that the one chosen among `candidates` has `percent`
/// (Bonferroni's inequality).
double confidence_of_each(double percent, int candidates) {
  return 100 - (100 - percent) / candidates;
}

}  // namespace

RefreshResult judge(const storage::Archive& archive, const storage::Registry& registry,
                    const RefreshRequest& request, PreparedWindow&& prepared) {
  RefreshResult result;
  if (prepared.candidate) {
    prepared.timer.begin("adapt");
    const int candidates = choose_candidate(registry, request, prepared);
    prepared.timer.begin("diagnose");
    describe_candidate(prepared);
    prepared.timer.begin("judge");
    try {
      result.evidence =
          evidence_of(archive, registry, request, prepared,
                      confidence_of_each(request.equipment.confidence_percent, candidates));
    } catch (const storage::Error& error) {  // the champion is run on telemetry of its own
      if (error.kind() != storage::Error::Kind::corrupt) throw;
      refuse_damaged(prepared, error);
    }
  }
  if (prepared.candidate) {
    const GateDecision decision = decide(result.evidence, request.equipment);
    describe(result.evidence, prepared.evidence);
    prepared.evidence["limits"] = limits_json(request.equipment);
    if (!result.evidence.baseline && request.equipment.baseline_mrse_percent)
      prepared.evidence["baseline_mrse_percent"] = *request.equipment.baseline_mrse_percent;
    prepared.attempt.outcome = name(decision.outcome);
    prepared.attempt.reason = sentences(decision.reasons);
    prepared.evidence["reasons"] = to_json(decision.reasons);
    result.decision =
        storage::NewDecision{kind_of(decision.outcome), "gate", prepared.attempt.reason};
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
  return judge(archive, registry, request, prepare_window(archive, request, kept, for_each, stop));
}

}  // namespace reident
