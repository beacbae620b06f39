#include <algorithm>

#include "service/model/derived_inputs.hpp"
#include "service/model/status_json.hpp"
#include "service/review/evidence.hpp"
#include "service/review/verdict.hpp"
#include "service/support/utc_clock.hpp"
#include "service/web/questions.hpp"
#include "service/web/views.hpp"

namespace reident::web {
namespace {

using storage::EquipmentName;

constexpr std::int64_t usual_versions = 200, most_versions = 2000;

Json hold_value(const std::optional<storage::Hold>& hold) {
  if (!hold) return {};
  return {{"actor", hold->actor}, {"reason", hold->reason}, {"since", time_value(hold->since)}};
}

Json decision_value(const storage::Decision& decision, storage::Time place) {
  return {{"id", id_value(decision.id)},
          {"time", time_value(decision.time)},
          {"telemetry", time_value(place)},
          {"kind", storage::name(decision.kind)},
          {"version", id_value(decision.version)},
          {"actor", decision.actor},
          {"reason", decision.reason}};
}

Json alarm_value(const storage::Alarm& alarm) {
  Json value = name_value(alarm.about);
  value["code"] = alarm.code;
  value["text"] = alarm.text;
  value["since"] = time_value(alarm.since);
  value["acknowledged_by"] = alarm.acknowledged_by;
  return value;
}

Json alarm_values(const std::vector<storage::Alarm>& alarms) {
  Json list = Json::array();
  for (const storage::Alarm& alarm : alarms) list.push_back(alarm_value(alarm));
  return list;
}

Json ids_value(const std::vector<std::int64_t>& ids) {
  Json list = Json::array();
  for (const std::int64_t id : ids) list.push_back(id_value(id));
  return list;
}

Json overview_line(const Stored& stored, const history::OverviewRow& row,
                   const std::vector<storage::Alarm>& alarms) {
  Json line = name_value(row.name);
  const auto made = stored.history.champion_decision(row.name);
  const auto failure = std::find_if(alarms.begin(), alarms.end(), [&row](const auto& alarm) {
    return alarm.about == row.name && alarm.code == "champion_failed";
  });
  line["champion"] = made ? id_value(made->version) : Json();
  line["since"] = made ? time_value(made->time) : Json();
  line["decided_by"] = made ? Json(made->actor) : Json();
  line["error_percent"] = number_value(row.error_percent);
  line["approved_error_percent"] = number_value(row.approved_error_percent);
  line["simulator_percent"] = number_value(row.simulator_percent);
  line["failure"] = failure != alarms.end() ? Json(failure->text) : Json();
  line["change"] = row.change ? time_value(row.change->since) : Json();
  line["hold"] = hold_value(row.hold);
  line["waiting"] = ids_value(row.waiting);
  line["telemetry"] = row.telemetry ? time_value(*row.telemetry) : Json();
  line["simulators"] = row.simulators;
  line["current"] = row.current;
  line["attempts"] = row.attempts;
  line["versions"] = row.versions;
  return line;
}

Json signal_values(const std::vector<Signal>& signals) {
  Json list = Json::array();
  for (const Signal& signal : signals)
    list.push_back({{"name", signal.name},
                    {"unit", signal.unit},
                    {"low", number_value(signal.low)},
                    {"high", number_value(signal.high)},
                    {"expression", signal.expression}});
  return list;
}

Json version_line(const storage::Attempt& attempt, const std::string& status,
                  const std::optional<std::int64_t>& parent) {
  const auto evidence = evidence_of(attempt);
  const auto interval =
      evidence.value(Json::json_pointer("/diagnostics/mrse_interval_percent"), Json());
  const bool has_interval = interval.is_object() && interval.contains("mean_low");
  return {{"version", id_value(*attempt.version)},
          {"status", status},
          {"parent", parent ? id_value(*parent) : Json()},
          {"window", range_value(attempt.window)},
          {"time", time_value(attempt.time)},
          {"outcome", attempt.outcome},
          {"order", evidence.value("order", Json())},
          {"error_percent", evidence.value("mrse_percent", Json())},
          {"fit_percent", evidence.value("fit_percent", Json())},
          {"interval_percent",
           has_interval ? Json::array({interval["mean_low"], interval["mean_high"]}) : Json()}};
}

}  // namespace

Json overview_view(const Stored& stored, const Config& config,
                   const std::vector<ServiceStatus>& heard) {
  auto alarms = stored.history.alarms();
  if (heard.empty() && !storage::Database::has_writer(config.database))
    alarms.insert(alarms.begin(), history::no_service_alarm(config.database, utc_now()));
  history::add_full_disk(config.database, utc_now(), alarms);
  history::add_alarms_of(heard, alarms);
  auto rows = stored.history.overview();
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      history::add_untried({spacecraft.name, equipment.name}, rows);
  history::put_worst_first(rows, alarms);
  Json lines = Json::array(), pair = Json::array();
  for (const history::OverviewRow& row : rows) lines.push_back(overview_line(stored, row, alarms));
  for (const ServiceStatus& service : heard)
    if (!service.pair.empty()) pair.push_back(pair_json(service));
  return {
      {"equipment", std::move(lines)}, {"alarms", alarm_values(alarms)}, {"pair", std::move(pair)}};
}

Json waiting_view(const Stored& stored, const HttpRequest&) {
  Json list = Json::array();
  for (const history::WaitingRow& row : stored.history.waiting()) {
    const EquipmentName name{row.decision.spacecraft, row.decision.equipment};
    const auto story = stored_version(stored.history, name, row.decision.version);
    if (!story) continue;
    Json line = name_value(name);
    line["version"] = id_value(row.decision.version);
    line["since"] = time_value(row.decision.time);
    line["window"] = range_value(row.window);
    const Verdict verdict = verdict_of(stored.history, *story);
    line["error_percent"] = verdict.now && verdict.now->blocks > 0
                                ? Json(verdict.now->mrse_percent)
                                : evidence_of(story->attempt).value("mrse_percent", Json());
    line["verdict"] = verdict.sentence;
    line["supersedes"] = ids_value(row.supersedes);
    list.push_back(std::move(line));
    stored.check_time();
  }
  return {{"waiting", std::move(list)}};
}

Json simulators_view(const Stored& stored, const HttpRequest&) {
  Json list = Json::array();
  for (const storage::SimulatorState& state : stored.history.simulators()) {
    const auto made = stored.history.champion_decision(state.equipment);
    Json line = name_value(state.equipment);
    line["simulator"] = state.simulator;
    line["version"] = state.version > 0 ? id_value(state.version) : Json();
    line["champion"] = made ? id_value(made->version) : Json();
    line["offered"] = state.offered > 0 ? id_value(state.offered) : Json();
    line["refused"] = state.refused > 0 ? id_value(state.refused) : Json();
    line["reason"] = state.reason;
    line["mode"] = state.mode;
    line["from_cache"] = state.from_cache;
    line["since"] = state.since > 0 ? time_value(state.since) : Json();
    line["host"] = state.host;
    line["process"] = state.process;
    line["program_version"] = state.program_version;
    list.push_back(std::move(line));
  }
  return {{"simulators", std::move(list)}};
}

Json equipment_view(const Stored& stored, const HttpRequest& request) {
  const EquipmentName name = equipment_of(stored, request);
  Json view = name_value(name);
  const auto rows = stored.history.overview();
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&name](const auto& one) { return one.name == name; });
  if (row == rows.end()) throw BadRequest("the equipment has no attempts any more", 404);
  view["line"] = overview_line(stored, *row, stored.history.alarms());
  storage::HistoryFilter filter;
  filter.spacecraft = name.spacecraft;
  filter.equipment = name.equipment;
  filter.versions_only = true;
  filter.last =
      static_cast<std::size_t>(number_of(request, "versions", 1, most_versions, usual_versions));
  const auto summaries = stored.history.summaries(name);
  Json versions = Json::array();
  for (const storage::Attempt& attempt : stored.history.attempts(filter)) {
    const auto summary = std::find_if(summaries.begin(), summaries.end(), [&](const auto& one) {
      return one.number == attempt.version;
    });
    if (summary != summaries.end())
      versions.push_back(version_line(attempt, summary->status, summary->parent));
  }
  const auto extent = [&] {
    const storage::Archive archive(stored.database);
    return archive.extent(name.spacecraft, storage::Origin::real);
  }();
  view["telemetry"] = extent ? range_value(*extent) : Json();
  TelemetryClock clock(extent);
  Json decisions = Json::array();
  for (const storage::Decision& decision : stored.history.decisions(name))
    decisions.push_back(decision_value(decision, clock.place_of(decision)));
  const std::int64_t shown = [&]() -> std::int64_t {
    if (const auto made = stored.history.champion_decision(name)) return made->version;
    return summaries.empty() ? 0 : summaries.back().number;
  }();
  view["inputs"] = view["outputs"] = view["parameters"] = Json::array();
  if (const auto story = stored_version(stored.history, name, shown)) {
    view["inputs"] = signal_values(story->model.inputs);
    view["outputs"] = signal_values(story->model.outputs);
    view["parameters"] =
        InputExpressions(signal_names(story->model.inputs), derived_inputs(story->model.inputs))
            .parameters();
  }
  view["versions"] = std::move(versions);
  view["decisions"] = std::move(decisions);
  return view;
}

}  // namespace reident::web
