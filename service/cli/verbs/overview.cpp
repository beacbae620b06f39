#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <span>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/history_access.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/service_choice.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/fleet/instances.hpp"
#include "service/model/status_json.hpp"
#include "service/operations/commands.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli::overview_verb {
namespace {

using history::OverviewRow;
using nlohmann::ordered_json;
using storage::Alarm;
using storage::EquipmentName;
using storage::Time;

constexpr std::size_t width_without_terminal = 80;
constexpr std::size_t rows_of_screen = 20;  // of a fleet
constexpr double default_interval_s = 2;
constexpr double max_interval_s = 86'400;

struct Arguments {
  HistoryAccessOptions access;
  std::optional<std::string> fleet;
  bool watch = false;
  double interval_s = default_interval_s;
  bool json = false;
};

/// All that is shown.
struct Overview {
  std::vector<OverviewRow> rows;
  std::vector<Alarm> alarms;
  Time now = 0;
  std::size_t rows_shown = SIZE_MAX;  // in the table
  std::vector<ServiceStatus> pair;    // its services that are heard; empty without a pair
  std::string pair_problem;           // why they cannot be heard
};

Alarm no_service(std::string text, Time now) {
  return {"no_service", {}, std::move(text), now};
}

/// The overview of all instances of a folder.
Overview read_fleet(const std::string& folder) {
  WorkerPool workers(usable_cores());
  Overview overview{{}, {}, utc_now(), rows_of_screen, {}, {}};
  for (fleet::Instance& one : fleet::read_instances(folder, workers)) {
    if (!one.is_of_site) continue;
    std::ranges::move(one.rows, std::back_inserter(overview.rows));
    std::ranges::move(one.alarms, std::back_inserter(overview.alarms));
    if (!one.problem.empty())
      overview.alarms.push_back(no_service(one.name + ": " + one.problem, overview.now));
    else if (!one.has_service.value_or(false))
      overview.alarms.push_back(
          no_service("No service runs for " + one.name + ". Start it.", overview.now));
  }
  history::put_worst_first(overview.rows, overview.alarms);
  return overview;
}

/// The services of the pair, and the alarms of those that do not lead: the database has none of
/// them.
void hear_pair(const Config& config, Overview& overview) {
  try {
    auto heard = heard_services(endpoint_of(config), heartbeat_wait);
    if (const auto* refusal = std::get_if<Refusal>(&heard)) {
      overview.pair_problem = refusal->message;
      return;
    }
    overview.pair = std::get<std::vector<ServiceStatus>>(std::move(heard));
  } catch (const dds::Error& error) {
    overview.pair_problem = error.what();
    return;
  }
  std::erase_if(overview.pair,
                [&](const ServiceStatus& service) { return service.pair != config.pair; });
  history::add_alarms_of(overview.pair, overview.alarms);
}

/// Alarms of a pair are recorded by its leader, and a service whose certificate has ended leads
/// none.
void add_security_alarm(const Config& config, Overview& overview) {
  const std::string mistake = mistake_of_security(config);
  const bool is_recorded = std::ranges::count(overview.alarms, "certificate", &Alarm::code) > 0;
  if (!mistake.empty() && !is_recorded)
    overview.alarms.push_back({"certificate", {}, mistake, overview.now});
}

Overview read(const Readers& readers, const std::optional<Config>& config) {
  Overview overview{
      readers.history.overview(), readers.history.alarms(), utc_now(), SIZE_MAX, {}, {}};
  if (config) {
    for (const EquipmentName& name : equipment_of(*config))
      history::add_untried(name, overview.rows);
    if (!storage::Database::has_writer(config->database))
      overview.alarms.insert(overview.alarms.begin(),
                             history::no_service_alarm(config->database, overview.now));
    history::add_full_disk(config->database, overview.now, overview.alarms);
  }
  if (config) add_security_alarm(*config, overview);
  if (config && !config->pair.empty()) hear_pair(*config, overview);
  history::put_worst_first(overview.rows, overview.alarms);
  return overview;
}

bool is_seen_to(const Alarm& alarm) {
  return !alarm.acknowledged_by.empty();
}

bool needs_action(const Overview& overview) {
  return !std::all_of(overview.alarms.begin(), overview.alarms.end(), is_seen_to) ||
         std::any_of(overview.rows.begin(), overview.rows.end(),
                     [](const OverviewRow& row) { return !row.waiting.empty(); });
}

std::string percent_text(const std::optional<double>& percent) {
  return percent ? fmt::format("{:.3g}", *percent) : "-";
}

/// What is to be known of an equipment in addition to its figures.
std::string notes_of(const OverviewRow& row, const Overview& overview) {
  std::vector<std::string> notes;
  for (const Alarm& alarm : overview.alarms)
    if (alarm.about == row.name) notes.push_back(alarm.code);
  if (!row.waiting.empty()) {
    std::vector<std::string> versions;
    for (const std::int64_t version : row.waiting) versions.push_back(std::to_string(version));
    notes.push_back(fmt::format("{} {}", joined(versions), versions.size() > 1 ? "wait" : "waits"));
  }
  if (row.change)
    notes.push_back("changed " + time_text(row.change->since).substr(0, sizeof "2017-07-01" - 1));
  if (row.hold) notes.push_back("held by " + row.hold->actor);
  std::string text;
  for (const std::string& note : notes) text += (text.empty() ? "" : "; ") + note;
  return text;
}

std::string table_text(const Overview& overview, std::size_t width) {
  constexpr auto right = Table::Align::right;
  Table table({{"equipment"},
               {"version", right},
               {"since", right},
               {"error %", right},
               {"then %", right},
               {"own %", right},
               {"telemetry", right},
               {"sims", right},
               {"to know"}});
  const bool colours = shows_colours();
  const std::size_t shown = std::min(overview.rows_shown, overview.rows.size());
  for (const OverviewRow& row : std::span(overview.rows).first(shown)) {
    const auto ago = [&](Time time) { return rough_duration_text(overview.now - time); };
    const bool has_champion = row.champion > 0;
    table.add({full_name(row.name), has_champion ? std::to_string(row.champion) : "none",
               has_champion ? ago(row.since) : "-", percent_text(row.error_percent),
               percent_text(row.approved_error_percent), percent_text(row.simulator_percent),
               row.telemetry ? ago(*row.telemetry) : "-",
               row.simulators > 0 ? fmt::format("{}/{}", row.current, row.simulators) : "-",
               notes_of(row, overview)},
              colours && history::needs_action(row, overview.alarms) ? Table::Look::urgent
                                                                     : Table::Look::plain);
  }
  std::string text = table.text(width);
  if (shown < overview.rows.size())
    text += fmt::format("and {} more; --json lists all\n", overview.rows.size() - shown);
  return text;
}

std::string name_of(const EquipmentName& about) {
  if (about.spacecraft.empty()) return "-";
  return about.equipment.empty() ? about.spacecraft : full_name(about);
}

std::string alarms_text(const Overview& overview, std::size_t width) {
  if (overview.alarms.empty()) return {};
  Table table({{"alarm"}, {"about"}, {"since", Table::Align::right}, {"seen by"}, {"what"}});
  const bool colours = shows_colours();
  const std::size_t shown = std::min(overview.rows_shown, overview.alarms.size());
  for (const Alarm& alarm : std::span(overview.alarms).first(shown)) {
    table.add({alarm.code, name_of(alarm.about), rough_duration_text(overview.now - alarm.since),
               is_seen_to(alarm) ? alarm.acknowledged_by : "-", alarm.text},
              colours && !is_seen_to(alarm) ? Table::Look::urgent : Table::Look::plain);
  }
  return "\n" + table.text(width);
}

void print_text(const Overview& overview) {
  const std::size_t width = terminal_width() > 0 ? terminal_width() : width_without_terminal;
  if (overview.rows.empty())
    fmt::print("no window was tried yet\n");
  else
    fmt::print("{}", table_text(overview, width));
  fmt::print("{}", alarms_text(overview, width));
  for (const ServiceStatus& service : overview.pair)
    fmt::print("\nservice {} {} in term {}{}", service.service, service.role, service.term,
               service.lag < 0 ? "" : fmt::format(", {} rows behind", service.lag));
  if (!overview.pair.empty()) fmt::print("\n");
  if (!overview.pair_problem.empty())
    fmt::print("\nthe pair cannot be heard: {}\n", overview.pair_problem);
}

ordered_json optional_json(const std::optional<double>& number) {
  return number ? ordered_json(*number) : ordered_json();
}

ordered_json row_json(const OverviewRow& row, const Overview& overview) {
  const bool has_champion = row.champion > 0;
  const auto time_json = [](bool is_there, Time time) {
    return is_there ? ordered_json(time_text(time)) : ordered_json();
  };
  ordered_json failure, change, hold;
  for (const Alarm& alarm : overview.alarms)
    if (alarm.about == row.name && alarm.code == "champion_failed")
      failure = {{"code", alarm.code}, {"text", alarm.text}};
  if (row.change)
    change = {{"champion", row.change->champion},
              {"since", time_text(row.change->since)},
              {"found", time_text(row.change->found)}};
  if (row.hold) hold = hold_json(*row.hold);
  return {{"spacecraft", row.name.spacecraft},
          {"equipment", row.name.equipment},
          {"act", history::needs_action(row, overview.alarms)},
          {"champion", has_champion ? ordered_json(row.champion) : ordered_json()},
          {"since", time_json(has_champion, row.since)},
          {"mrse_percent", optional_json(row.error_percent)},
          {"approved_mrse_percent", optional_json(row.approved_error_percent)},
          {"simulator_mrse_percent", optional_json(row.simulator_percent)},
          {"change", std::move(change)},
          {"waiting", row.waiting},
          {"hold", std::move(hold)},
          {"telemetry", time_json(row.telemetry.has_value(), row.telemetry.value_or(0))},
          {"simulators", row.simulators},
          {"simulators_current", row.current},
          {"windows_tried", row.attempts},
          {"versions", row.versions},
          {"published", row.approvals},
          {"failure", std::move(failure)}};
}

void print_json(const Overview& overview) {
  ordered_json rows = ordered_json::array(), alarms = ordered_json::array();
  for (const OverviewRow& row : overview.rows) rows.push_back(row_json(row, overview));
  for (const Alarm& alarm : overview.alarms) alarms.push_back(alarm_json(alarm));
  ordered_json pair = ordered_json::array();
  for (const ServiceStatus& service : overview.pair) pair.push_back(pair_json(service));
  ordered_json object = {{"time", time_text(overview.now)},
                         {"act", needs_action(overview)},
                         {"equipment", std::move(rows)},
                         {"alarms", std::move(alarms)}};
  if (!overview.pair.empty()) object["pair"] = std::move(pair);
  if (!overview.pair_problem.empty()) object["pair_problem"] = overview.pair_problem;
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

/// The configuration of the service that is asked, where it is on this machine.
std::optional<Config> local_config(const Arguments& arguments) {
  if (arguments.access.is_remote() || arguments.access.database.database) return std::nullopt;
  auto chosen = chosen_config(arguments.access.database.config);
  auto* config = std::get_if<std::optional<Config>>(&chosen);
  return config ? std::move(*config) : std::nullopt;
}

int show(const Arguments& arguments, const std::function<Overview()>& look) {
  const auto interval = std::chrono::duration<double>(arguments.interval_s);
  for (;;) {
    const Overview overview = look();
    if (arguments.watch && terminal_width() > 0) fmt::print("\033[H\033[2J");
    if (arguments.json)
      print_json(overview);
    else
      print_text(overview);
    if (!arguments.watch) return needs_action(overview) ? exit_failed : exit_done;
    fmt::print("{}\n", time_text(overview.now / 1'000'000'000 * 1'000'000'000));
    if (std::fflush(stdout) != 0) return exit_failed;
    std::this_thread::sleep_for(interval);
  }
}

int run(const Arguments& arguments) {
  if (arguments.fleet) {
    try {
      return show(arguments, [&] { return read_fleet(*arguments.fleet); });
    } catch (const std::invalid_argument& error) {
      return refuse({error.what()});
    }
  }
  const std::optional<Config> config = local_config(arguments);
  return with_readers(arguments.access, [&](const Readers& readers) {
    return show(arguments, [&] { return read(readers, config); });
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_access_options(command, arguments->access);
  command
      .add_option("--fleet", arguments->fleet,
                  "folder with the configurations of many services: all of their equipment")
      ->excludes("--config")
      ->excludes("--database")
      ->excludes("--remote");
  CLI::Option* watch = command.add_flag("--watch", arguments->watch, "again and again, until ^C");
  command.add_option("--every", arguments->interval_s, "seconds between two looks, with --watch")
      ->needs(watch)
      ->check(CLI::Range(0.1, max_interval_s))
      ->capture_default_str();
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "A line for each equipment, the worst first: its champion; the champion's error over the "
      "last two cycles, and then, when it was approved; the simulator's own model's; the age of "
      "its telemetry; simulators that run the champion, of all. Below are the alarms.\n"
      "Example:\n"
      "  reident overview --config reident.toml --watch\n"
      "Exit status: 0 when all is well; 1 when somebody has to act: an alarm that nobody has seen, "
      "or a version that waits.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"overview", "Show how the models of all equipment are now, the worst first, and the alarms",
     WorksOn::history, declare});

}  // namespace
}  // namespace reident::cli::overview_verb
