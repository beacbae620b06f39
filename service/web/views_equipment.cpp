#include <algorithm>
#include <map>

#include "service/judgement/scores.hpp"
#include "service/model/derived_inputs.hpp"
#include "service/review/evidence.hpp"
#include "service/review/stored_league.hpp"
#include "service/review/verdict.hpp"
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

/// Errors of the champion and of the simulator's own model on the champion's record.
void put_errors(const Stored& stored, const EquipmentName& name, std::int64_t champion,
                Json& line) {
  const Member member{champion, {}, stored.history.scores(name, champion)};
  Sums own, simulator;
  for (const storage::Block& block : stored.history.blocks(name)) {
    const storage::BlockScore* score = counts(block) ? find(member, block.range.begin) : nullptr;
    if (!score) continue;
    own.add(block, score->square);
    if (!block.baseline_square.empty()) simulator.add(block, block.baseline_square);
  }
  if (own.rows > 0) line["error_percent"] = number_value(own.mrse_percent());
  if (simulator.rows > 0) line["simulator_percent"] = number_value(simulator.mrse_percent());
}

/// The last decisions about versions for which all conditions but an operator's hold. Others that
/// wait are challengers: telemetry decides about them.
std::vector<storage::Decision> waiting_for_operator(const Stored& stored,
                                                    const EquipmentName& name) {
  std::map<std::int64_t, storage::Decision> last;
  for (storage::Decision& decision : stored.history.decisions(name))
    last[decision.version] = std::move(decision);
  std::vector<storage::Decision> waiting;
  for (auto& [version, decision] : last)
    if (decision.kind == storage::DecisionKind::wait && !decision.evidence_json.empty())
      waiting.push_back(std::move(decision));
  return waiting;
}

Json overview_line(const Stored& stored, const EquipmentName& name) {
  Json line = name_value(name);
  for (const char* key : {"champion", "since", "decided_by", "error_percent",
                          "approved_error_percent", "simulator_percent", "failure"})
    line[key] = nullptr;
  line["hold"] = hold_value(stored.history.hold(name));
  const auto versions = stored.history.summaries(name);
  const auto waiting = waiting_for_operator(stored, name);
  line["waiting"] = Json::array();
  for (const storage::Decision& decision : waiting)
    line["waiting"].push_back(id_value(decision.version));
  line["challengers"] =
      std::count_if(versions.begin(), versions.end(),
                    [](const auto& version) { return version.status == "waiting"; }) -
      static_cast<std::ptrdiff_t>(waiting.size());
  line["versions"] = versions.size();
  if (const auto last = stored.registry.last_window_end(name.spacecraft, name.equipment))
    line["tried_until"] = time_value(*last);
  const auto made = stored.history.champion_decision(name);
  if (!made) return line;
  line["champion"] = id_value(made->version);
  line["since"] = time_value(made->time);
  line["decided_by"] = made->actor;
  if (const auto attempt = stored.history.attempt(name, made->version)) {
    const auto evidence = evidence_of(*attempt);
    line["approved_error_percent"] = evidence.value("mrse_percent", Json());
    put_errors(stored, name, made->version, line);
    if (const auto failure = failure_now(stored.history, *attempt, made->version))
      line["failure"] = sentence(*failure);
  }
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

Json overview_view(const Stored& stored, const HttpRequest&) {
  Json lines = Json::array();
  for (const EquipmentName& name : stored.history.equipment()) {
    lines.push_back(overview_line(stored, name));
    stored.check_time();
  }
  return {{"equipment", std::move(lines)}};
}

Json waiting_view(const Stored& stored, const HttpRequest&) {
  Json list = Json::array();
  for (const EquipmentName& name : stored.history.equipment()) {
    for (const storage::Decision& decision : waiting_for_operator(stored, name)) {
      const auto story = stored_version(stored.history, name, decision.version);
      if (!story) continue;
      Json line = name_value(name);
      line["version"] = id_value(decision.version);
      line["since"] = time_value(decision.time);
      line["window"] = range_value(story->version.window);
      line["error_percent"] = evidence_of(story->attempt).value("mrse_percent", Json());
      line["verdict"] = verdict_of(stored.history, *story).sentence;
      list.push_back(std::move(line));
      stored.check_time();
    }
  }
  return {{"waiting", std::move(list)}};
}

Json equipment_view(const Stored& stored, const HttpRequest& request) {
  const EquipmentName name = equipment_of(stored, request);
  Json view = name_value(name);
  view["line"] = overview_line(stored, name);
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
