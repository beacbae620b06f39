#include "service/history/overview_rows.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "service/history/row_values.hpp"
#include "service/support/size_text.hpp"
#include "service/support/text.hpp"

namespace reident::history {
namespace {

using storage::Alarm;

constexpr std::string_view champion_failed = "champion_failed";

Json percent_value(const std::optional<double>& percent) {
  return percent ? number_value(*percent) : Json();
}

std::optional<double> read_percent(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(read_number(value));
}

bool is_unseen(const Alarm& alarm, const storage::EquipmentName& name) {
  return alarm.about == name && alarm.acknowledged_by.empty();
}

/// The less, the worse.
auto rank(const OverviewRow& row, const std::vector<Alarm>& alarms) {
  const auto any = [&](const auto& is) { return std::any_of(alarms.begin(), alarms.end(), is); };
  const bool fails = any(
      [&](const Alarm& alarm) { return alarm.about == row.name && alarm.code == champion_failed; });
  const bool is_alarming = any([&](const Alarm& alarm) { return is_unseen(alarm, row.name); });
  const double growth = row.error_percent && row.approved_error_percent
                            ? *row.error_percent / *row.approved_error_percent
                            : 0;
  return std::tuple(!fails, !is_alarming, row.waiting.empty(), row.champion > 0,
                    std::isnan(growth) ? -HUGE_VAL : -growth, row.name);
}

}  // namespace

Json row_of(const OverviewRow& row) {
  Json object = row_of(EquipmentRow{row.name, row.hold});
  Json change;
  if (row.change)
    change = {{"champion", row.change->champion},
              {"since_ns", row.change->since},
              {"found_ns", row.change->found}};
  object.update({{"champion", row.champion},
                 {"since_ns", row.since},
                 {"error_percent", percent_value(row.error_percent)},
                 {"approved_error_percent", percent_value(row.approved_error_percent)},
                 {"simulator_percent", percent_value(row.simulator_percent)},
                 {"change", std::move(change)},
                 {"waiting", row.waiting},
                 {"telemetry_ns", optional_value(row.telemetry)},
                 {"simulators", row.simulators},
                 {"current", row.current},
                 {"attempts", row.attempts},
                 {"versions", row.versions},
                 {"approvals", row.approvals}});
  return object;
}

void read_row(const Json& row, OverviewRow& overview) {
  EquipmentRow equipment;
  read_row(row, equipment);
  overview.name = std::move(equipment.name);
  overview.hold = std::move(equipment.hold);
  overview.champion = row.at("champion").get<std::int64_t>();
  overview.since = row.at("since_ns").get<storage::Time>();
  overview.error_percent = read_percent(row.at("error_percent"));
  overview.approved_error_percent = read_percent(row.at("approved_error_percent"));
  overview.simulator_percent = read_percent(row.at("simulator_percent"));
  if (const Json& change = row.at("change"); !change.is_null())
    overview.change = {change.at("champion").get<std::int64_t>(),
                       change.at("since_ns").get<storage::Time>(),
                       change.at("found_ns").get<storage::Time>()};
  overview.waiting = row.at("waiting").get<std::vector<std::int64_t>>();
  overview.telemetry = read_optional<storage::Time>(row.at("telemetry_ns"));
  overview.simulators = row.at("simulators").get<std::int64_t>();
  overview.current = row.at("current").get<std::int64_t>();
  overview.attempts = row.at("attempts").get<std::int64_t>();
  overview.versions = row.at("versions").get<std::int64_t>();
  overview.approvals = row.at("approvals").get<std::int64_t>();
}

Json row_of(const WaitingRow& row) {
  Json object = row_of(row.decision);
  object.update({{"window_begin_ns", row.window.begin},
                 {"window_end_ns", row.window.end},
                 {"supersedes", row.supersedes}});
  return object;
}

void read_row(const Json& row, WaitingRow& waiting) {
  read_row(row, waiting.decision);
  waiting.window = {row.at("window_begin_ns").get<storage::Time>(),
                    row.at("window_end_ns").get<storage::Time>()};
  waiting.supersedes = row.at("supersedes").get<std::vector<std::int64_t>>();
}

Json row_of(const Alarm& alarm) {
  return {{"code", text_value(alarm.code)},
          {"spacecraft", text_value(alarm.about.spacecraft)},
          {"equipment", text_value(alarm.about.equipment)},
          {"text", text_value(alarm.text)},
          {"since_ns", alarm.since},
          {"acknowledged_by", text_value(alarm.acknowledged_by)}};
}

void read_row(const Json& row, Alarm& alarm) {
  alarm = {read_text(row.at("code")),
           {read_text(row.at("spacecraft")), read_text(row.at("equipment"))},
           read_text(row.at("text")),
           row.at("since_ns").get<storage::Time>(),
           read_text(row.at("acknowledged_by"))};
}

Json row_of(const storage::SimulatorState& state) {
  return {{"simulator", text_value(state.simulator)},
          {"spacecraft", text_value(state.equipment.spacecraft)},
          {"equipment", text_value(state.equipment.equipment)},
          {"version", state.version},
          {"offered", state.offered},
          {"refused", state.refused},
          {"reason", text_value(state.reason)},
          {"mode", text_value(state.mode)},
          {"from_cache", state.from_cache},
          {"since_ns", state.since},
          {"host", text_value(state.host)},
          {"process", state.process},
          {"program_version", text_value(state.program_version)},
          {"time_ns", state.time}};
}

void read_row(const Json& row, storage::SimulatorState& state) {
  state.simulator = read_text(row.at("simulator"));
  state.equipment = {read_text(row.at("spacecraft")), read_text(row.at("equipment"))};
  state.version = row.at("version").get<std::int64_t>();
  state.offered = row.at("offered").get<std::int64_t>();
  state.refused = row.at("refused").get<std::int64_t>();
  state.reason = read_text(row.at("reason"));
  state.mode = read_text(row.at("mode"));
  state.from_cache = row.at("from_cache").get<bool>();
  state.since = row.at("since_ns").get<storage::Time>();
  state.host = read_text(row.at("host"));
  state.process = row.at("process").get<std::uint64_t>();
  state.program_version = read_text(row.at("program_version"));
  state.time = row.at("time_ns").get<storage::Time>();
}

bool needs_action(const OverviewRow& row, const std::vector<Alarm>& alarms) {
  return !row.waiting.empty() || std::any_of(alarms.begin(), alarms.end(), [&](const Alarm& alarm) {
    return is_unseen(alarm, row.name);
  });
}

void add_untried(const storage::EquipmentName& name, std::vector<OverviewRow>& rows) {
  if (std::ranges::find(rows, name, &OverviewRow::name) == rows.end())
    rows.emplace_back().name = name;
}

Alarm no_service_alarm(const std::filesystem::path& database, storage::Time now) {
  return {"no_service",
          {},
          "No service runs on " + database.string() +
              ": what is below is as the last one left it. Start reidentd.",
          now};
}

void add_full_disk(const std::filesystem::path& database, storage::Time now,
                   std::vector<Alarm>& alarms) {
  constexpr std::uint64_t least_room = std::uint64_t{256} << 20;
  if (std::ranges::count(alarms, "disk", &Alarm::code) > 0) return;
  std::error_code error;
  const auto folder = std::filesystem::absolute(database).parent_path();
  const auto room = std::filesystem::space(folder, error);
  if (error || room.available >= least_room) return;
  alarms.push_back({"disk",
                    {},
                    fmt::format("Less than {} is left on the disk of {}. Make room, or give the "
                                "archive a max_size.",
                                size_text(least_room), folder.string()),
                    now});
}

void add_alarms_of(const std::vector<ServiceStatus>& services, std::vector<Alarm>& alarms) {
  for (const ServiceStatus& service : services) {
    if (service.pair.empty() || service.role == "leads") continue;
    for (const std::string& line : lines_of(service.alarms)) {
      const std::string code = line.substr(0, line.find_first_of(" :"));
      if (std::none_of(alarms.begin(), alarms.end(),
                       [&code](const Alarm& alarm) { return alarm.code == code; }))
        alarms.push_back({code, {}, service.service + ": " + line, service.time});
    }
  }
}

void put_worst_first(std::vector<OverviewRow>& rows, const std::vector<Alarm>& alarms) {
  using Rank = decltype(rank(rows.front(), alarms));
  std::vector<std::pair<Rank, OverviewRow>> ranked;
  ranked.reserve(rows.size());
  for (OverviewRow& row : rows) ranked.emplace_back(rank(row, alarms), std::move(row));
  std::ranges::sort(ranked, {}, &std::pair<Rank, OverviewRow>::first);
  std::ranges::transform(ranked, rows.begin(), [](auto& one) { return std::move(one.second); });
}

}  // namespace reident::history
