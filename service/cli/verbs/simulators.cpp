#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/partition_survey.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::simulators_verb {
namespace {

using nlohmann::ordered_json;

constexpr double default_wait_s = 10;
constexpr double max_wait_s = 1e6;

struct Arguments {
  std::optional<std::string> config;
  std::optional<std::uint32_t> domain;
  std::optional<std::string> partition;
  std::string subject;
  double wait_s = default_wait_s;
  bool old = false;
  bool json = false;
};

/// One line of a table: what a simulator says may hold line breaks.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  return text;
}

std::optional<double> outside_percent(const RunningModel& running) {
  if (running.steps == 0) return std::nullopt;
  return 100 * static_cast<double>(running.steps_outside) / static_cast<double>(running.steps);
}

std::string number_or(std::int64_t number, const char* none) {
  return number > 0 ? fmt::format("{}", number) : none;
}

std::string figure(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

/// `brief`: without what a narrow terminal has no room for.
std::string table_text(const std::vector<SimulatorRow>& rows, bool has_service, bool brief,
                       std::size_t width) {
  constexpr auto right = Table::Align::right;
  std::vector<Table::Column> columns = {
      {"simulator"},   {"host"}, {"equipment"},     {"version", right},   {"champion", right},
      {"since (UTC)"}, {"mode"}, {"MRSE %", right}, {"outside %", right}, {"state"}};
  const auto shortened = [brief](auto cells) {
    if (brief) {
      cells.erase(cells.begin() + 5);
      cells.erase(cells.begin() + 1);
    }
    return cells;
  };
  constexpr storage::Time second = 1'000'000'000;
  Table table(shortened(columns));
  for (const SimulatorRow& row : rows) {
    const RunningModel& running = row.said.running;
    const auto outside = outside_percent(running);
    table.add(shortened(std::vector<std::string>{
        row.said.simulator, one_line(row.said.host), row.said.spacecraft + "/" + row.said.equipment,
        number_or(running.version, "-"),
        number_or(row.champion ? row.champion->number : 0, has_service ? "-" : "?"),
        running.since > 0 ? time_text(running.since / second * second) : "-",
        running.mode.empty() ? "-" : one_line(running.mode), figure(running.mrse_percent, 3),
        outside ? figure(*outside, 1) : "-", one_line(row.text())}));
  }
  return table.text(width);
}

bool fits(std::string_view text, std::size_t width) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (display_width(text.substr(begin, end - begin)) > width) return false;
    begin = end + 1;
  }
  return true;
}

void print_text(const Arguments& arguments, const dds::Endpoint& endpoint,
                const PartitionSurvey& sight, const std::vector<SimulatorRow>& rows) {
  const std::string place =
      fmt::format("domain {}, partition {}", endpoint.domain, endpoint.partition);
  const bool has_service = sight.services > 0;
  if (rows.empty()) {
    const std::string whose =
        arguments.subject.empty() ? std::string() : " of " + arguments.subject;
    fmt::print("no simulator{} {} on {}\n", whose,
               arguments.old ? "runs something old" : "is there", place);
  } else {
    const std::size_t width = terminal_width();
    std::string text = table_text(rows, has_service, false, width);
    if (width > 0 && !fits(text, width)) text = table_text(rows, has_service, true, width);
    fmt::print("{}", text);
  }
  if (!has_service)
    fmt::print("no service publishes versions on {}: which version is champion is not known{}\n",
               place, why_unheard(endpoint, arguments.config));
  if (sight.services > 1) fmt::print("{} services publish versions on {}\n", sight.services, place);
}

ordered_json time_json(storage::Time time) {
  return time == 0 ? ordered_json() : ordered_json(time_text(time));
}

ordered_json version_json(std::int64_t number) {
  return number == 0 ? ordered_json() : ordered_json(number);
}

ordered_json row_json(const SimulatorRow& row) {
  const ModelAcknowledgement& said = row.said;
  const RunningModel& running = said.running;
  const auto outside = outside_percent(running);
  ordered_json json = {
      {"simulator", said.simulator},
      {"host", text_json(said.host)},
      {"process", said.process},
      {"program_version", text_json(said.program_version)},
      {"spacecraft", said.spacecraft},
      {"equipment", said.equipment},
      {"version", version_json(running.version)},
      {"champion", version_json(row.champion ? row.champion->number : 0)},
      {"champion_since", time_json(row.champion ? row.champion->decided : 0)},
      {"state", name(row.state)},
      {"old", row.is_old()},
      {"text", row.text()},
      {"since", time_json(running.since)},
      {"decided", time_json(running.decided)},
      {"from_file", running.from_cache},
      {"mode", text_json(running.mode)},
      {"running_mrse_percent",
       std::isfinite(running.mrse_percent) ? ordered_json(running.mrse_percent) : ordered_json()},
      {"steps", running.steps},
      {"steps_outside", running.steps_outside},
      {"steps_missing", running.steps_missing},
      {"outside_percent", outside ? ordered_json(*outside) : ordered_json()},
      {"remaining_step", running.remaining_step},
      {"transition_steps", running.transition_steps},
      {"offered", version_json(running.offered_version)},
      {"refused", nullptr}};
  if (!said.accepted) json["refused"] = {{"version", said.version}, {"reason", said.reason}};
  return json;
}

void print_json(const dds::Endpoint& endpoint, const PartitionSurvey& sight,
                const std::vector<SimulatorRow>& rows) {
  ordered_json list = ordered_json::array();
  for (const SimulatorRow& row : rows) list.push_back(row_json(row));
  const ordered_json object = {{"domain", endpoint.domain},
                               {"partition", endpoint.partition},
                               {"services", sight.services},
                               {"simulators", list}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  const auto found = chosen_endpoint(arguments.config, arguments.domain, arguments.partition);
  if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
  const auto wanted = parse_equipment(arguments.subject);
  if (const auto* refusal = std::get_if<Refusal>(&wanted)) return refuse(*refusal);
  const dds::Endpoint& endpoint = std::get<dds::Endpoint>(found);
  const PartitionSurvey sight =
      look_into(endpoint, std::chrono::duration_cast<std::chrono::nanoseconds>(
                              std::chrono::duration<double>(arguments.wait_s)));
  if (sight.misses_security && sight.simulators.empty()) return refuse(missing_security(endpoint));
  auto rows = list_simulators(sight, std::get<storage::EquipmentName>(wanted));
  const bool any = !rows.empty();
  if (arguments.old) std::erase_if(rows, [](const SimulatorRow& row) { return !row.is_old(); });
  if (arguments.json)
    print_json(endpoint, sight, rows);
  else
    print_text(arguments, endpoint, sight, rows);
  if (!arguments.old) return exit_done;
  if (any && sight.services == 0) return exit_timed_out;
  return rows.empty() ? exit_done : exit_failed;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("equipment", arguments->subject,
                     "EQUIPMENT or SPACECRAFT/EQUIPMENT (every one)");
  command.add_option(
      "--config", arguments->config,
      fmt::format("configuration with domain and partition ({})", default_config_file));
  command.add_option("--domain", arguments->domain, "DDS domain")->check(CLI::Range(0, 230));
  command.add_option("--partition", arguments->partition, "DDS partition");
  command.add_flag("--old", arguments->old,
                   "those alone that run another version than the champion");
  command
      .add_option(
          "--wait", arguments->wait_s,
          "seconds to listen at most; it ends once nobody new was heard for a second or two")
      ->check(CLI::Range(0.0, max_wait_s))
      ->capture_default_str();
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Example:\n"
      "  reident simulators CBERS-4/BDR --old\n"
      "Exit status: 0 when the list was printed, also an empty one; with --old 1 when somebody is "
      "on it, and 4 when there are simulators and no service says which version is champion.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"simulators", "List over DDS who runs which version, and who runs something old",
     WorksOn::service, declare});

}  // namespace

}  // namespace reident::cli::simulators_verb
