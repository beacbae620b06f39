#include "service/review/stored_league.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "service/review/evidence.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using nlohmann::ordered_json;
using storage::EquipmentName;

/// The limits that the attempt's evidence holds.
EquipmentConfig limits_of(const ordered_json& evidence, std::vector<std::string>& unbound) {
  EquipmentConfig limits;
  const ordered_json json = evidence.value("limits", ordered_json::object());
  const auto read = [&json](const char* key, auto& value) {
    if (const auto found = json.find(key); found != json.end() && !found->is_null())
      value = found->get<std::remove_reference_t<decltype(value)>>();
  };
  read("max_mrse_percent", limits.max_mrse_percent);
  read("margin_percent", limits.margin_percent);
  read("confidence_percent", limits.confidence_percent);
  read("min_interval_ns", limits.min_interval);
  read("cycle_ns", limits.cycle);
  read("members", limits.members);
  read("unbound", unbound);
  read("regime_inputs", limits.regime_inputs);
  if (json.value("bias", "wait") == "approve") limits.bias = BiasPolicy::approve;
  return limits;
}

Member member_of(const history::HistoryReader& history, const EquipmentName& equipment,
                 std::int64_t version, storage::TimeRange window) {
  const auto found = history.version(equipment, version);
  const bool is_known = found && !mistake_in(*found);
  const storage::Time record =
      is_known ? equipment_model_from_json(found->model_json).validated_on.begin : window.end;
  return {version, window, record, history.scores(equipment, version)};
}

}  // namespace

const Member& StoredRecord::member(std::int64_t version) const {
  return *std::find_if(league.challengers.begin(), league.challengers.end(),
                       [version](const Member& one) { return one.version == version; });
}

std::optional<StoredRecord> stored_record(const history::HistoryReader& history,
                                          const StoredVersion& story) {
  const storage::Version& version = story.version;
  const EquipmentName equipment{version.spacecraft, version.equipment};
  std::optional<std::int64_t> rival = version.parent;
  std::optional<storage::Decision> made;
  if (version.status == "waiting") {
    made = history.champion_decision(equipment);
    rival = made ? std::optional(made->version) : std::nullopt;
  }
  if (!rival) return std::nullopt;
  StoredRecord record;
  record.limits = limits_of(evidence_of(story.attempt), record.league.unbound);
  record.league.outputs = signal_names(story.model.outputs);
  record.league.biases =
      biases_of(signal_names(story.model.inputs), derived_inputs(story.model.inputs));
  std::vector<storage::VersionSummary> waiting = history.summaries(equipment);
  if (made && made->kind == storage::DecisionKind::approve && made->actor == "gate") {
    for (const storage::VersionSummary& one : waiting)
      if (one.number == *rival) record.league.replaced = one.parent;
    record.league.replaced_at = judged_until(*made).value_or(INT64_MIN);
  }
  std::erase_if(waiting, [](const auto& one) { return one.status != "waiting"; });
  storage::HistoryFilter versions;
  versions.spacecraft = equipment.spacecraft;
  versions.equipment = equipment.equipment;
  versions.versions_only = true;
  for (const storage::Attempt& attempt : history.attempts(versions)) {
    const std::int64_t number = *attempt.version;
    if (attempt.outcome == name(Outcome::challenger))
      record.league.admitted.push_back(attempt.window);
    const bool waits = std::any_of(waiting.begin(), waiting.end(),
                                   [number](const auto& one) { return one.number == number; });
    if (number == *rival)
      record.league.champion = member_of(history, equipment, number, attempt.window);
    else if (number == version.number || number == record.league.replaced ||
             (waits && version.status == "waiting"))
      record.league.challengers.push_back(member_of(history, equipment, number, attempt.window));
  }
  if (!record.league.champion || record.league.champion->scores.empty() ||
      record.member(version.number).scores.empty())
    return std::nullopt;
  if (made)
    record.league.changed = changed_in(*made).value_or(record.league.champion->window.begin);
  record.league.blocks = history.blocks(equipment);
  record.change = Judge(record.limits).change(record.league);
  return record;
}

std::optional<Reason> failure_now(const history::HistoryReader& history,
                                  const storage::Attempt& attempt, std::int64_t champion) {
  const EquipmentName equipment{attempt.spacecraft, attempt.equipment};
  League league;
  const EquipmentConfig limits = limits_of(evidence_of(attempt), league.unbound);
  league.champion = member_of(history, equipment, champion, attempt.window);
  league.blocks = history.blocks(equipment);
  return Judge(limits).failure(league);
}

std::optional<Finding> finding_now(const StoredRecord& record, const StoredVersion& story) {
  if (story.version.status != "waiting") return std::nullopt;
  for (const Finding& finding : Judge(record.limits).findings(record.league))
    if (finding.version == story.version.number) return finding;
  return std::nullopt;
}

}  // namespace reident
