#include "service/operations/backfill.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/file_errors.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/phase_advice.hpp"
#include "service/cli/time_options.hpp"
#include "service/cli/verb.hpp"
#include "service/history/stored_readers.hpp"
#include "service/operations/commands.hpp"
#include "service/support/progress.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"
#include "service/windows/window_data.hpp"
#include "storage/archive/holdings.hpp"

namespace reident::cli::backfill_verb {
namespace {

struct Arguments {
  std::optional<std::string> config;
  std::string subject;
  TimeOptions time;
  bool json = false;
};

std::variant<BackfillRequest, Refusal> request_of(const Arguments& arguments,
                                                  const Config& config) {
  BackfillRequest request;
  const auto range = chosen_range(arguments.time, {0, utc_now()});
  if (const auto* refusal = std::get_if<Refusal>(&range)) return *refusal;
  request.range = std::get<storage::TimeRange>(range);
  if (arguments.subject.empty()) return request;
  const auto subject = parse_subject(arguments.subject);
  if (const auto* refusal = std::get_if<Refusal>(&subject)) return *refusal;
  request.spacecraft = std::get<Subject>(subject).spacecraft;
  request.equipment = std::get<Subject>(subject).equipment;
  std::vector<std::string> names;
  for (const storage::EquipmentName& one : equipment_of(config)) {
    if (one.equipment == request.equipment &&
        (request.spacecraft.empty() || request.spacecraft == one.spacecraft))
      return request;
    names.push_back(full_name(one));
  }
  return Refusal{fmt::format("the configuration has no equipment {}; it has {}", arguments.subject,
                             joined(names))};
}

/// Says of each equipment that is wanted what of it no telemetry has. Returns whether there is one
/// of which it has all.
bool say_what_is_unknown(const storage::Database& database, const Config& config,
                         const BackfillRequest& wanted) {
  constexpr std::ptrdiff_t most_named = 20;
  std::map<std::string, std::vector<std::string>> known;  // by spacecraft
  for (const storage::SeriesInfo& series : storage::all_series(database))
    if (series.origin == storage::Origin::real) known[series.spacecraft].push_back(series.name);
  bool is_any_known = false;
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment) {
      if ((!wanted.spacecraft.empty() && wanted.spacecraft != spacecraft.name) ||
          (!wanted.equipment.empty() && wanted.equipment != equipment.name))
        continue;
      const std::vector<std::string>& names = known[spacecraft.name];
      const std::string unknown = unknown_among(parameters_of(equipment), names);
      is_any_known = is_any_known || unknown.empty();
      if (unknown.empty()) continue;
      std::vector<std::string> some(
          names.begin(), names.begin() + std::min<std::ptrdiff_t>(std::ssize(names), most_named));
      if (some.size() < names.size()) some.push_back("...");
      print_error(
          "reident: {}/{}: no telemetry has {}; {} has {}: correct the configuration, or "
          "import what is missing",
          spacecraft.name, equipment.name, unknown, spacecraft.name,
          names.empty() ? "none" : joined(some));
    }
  return is_any_known;
}

void print(const BackfillProgress& progress, storage::Database& database, bool json) {
  const history::StoredHistory history(database);
  const std::size_t waiting = history.waiting().size(), alarms = history.alarms().size();
  if (json) {
    const nlohmann::ordered_json object = {{"windows", progress.windows},
                                           {"done", progress.done},
                                           {"approved", progress.approved},
                                           {"waiting", waiting},
                                           {"alarms", alarms}};
    fmt::print("{}\n", object.dump());
    return;
  }
  fmt::print("{} of {} windows tried, {} versions approved\n", progress.done, progress.windows,
             progress.approved);
  if (progress.done < progress.windows)
    fmt::print("stopped; the same command goes on where it ended\n");
  if (waiting + alarms > 0)
    fmt::print("{} versions wait for an operator, {} alarms stand: reident overview shows them\n",
               waiting, alarms);
}

int run(const Arguments& arguments) {
  auto chosen = chosen_config(arguments.config);
  if (const auto* refusal = std::get_if<Refusal>(&chosen)) return refuse(*refusal);
  const auto& config = std::get<std::optional<Config>>(chosen);
  if (!config)
    return refuse({fmt::format("no configuration: there is no {} here; name one with --config FILE",
                               default_config_file)});
  const auto request = request_of(arguments, *config);
  if (const auto* refusal = std::get_if<Refusal>(&request)) return refuse(*refusal);
  const StopSignal stop;
  return refusing_what_cannot_be([&]() -> int {
    storage::Database database(config->database, storage::Database::Mode::update);
    if (!config->pair.empty() || !storage::Registry(database).journal().is_of(config->service_name))
      return refuse(
          {fmt::format("{} is the database of a pair of services, whose leader alone "
                       "records attempts: it tries what it has telemetry of by itself",
                       config->database.string())});
    const auto& wanted = std::get<BackfillRequest>(request);
    const bool is_any_known = say_what_is_unknown(database, *config, wanted);
    for (const std::string& sentence :
         advised_phases(database, *config, wanted.spacecraft, wanted.equipment))
      print_error("reident: {}", sentence);
    WorkerPool workers(usable_cores());
    Progress bar;
    const BackfillProgress progress = backfill(
        database, *config, std::get<BackfillRequest>(request), workers,
        [](storage::Time) { return utc_now(); },
        [&](const BackfillProgress& at) {
          bar.update(static_cast<double>(at.done) / static_cast<double>(at.windows),
                     fmt::format("{}/{} {} {} approved {}", at.done, at.windows, at.equipment,
                                 time_text(at.window_end), at.approved));
          return !stop.token().stop_requested();
        });
    bar.clear();
    print(progress, database, arguments.json);
    if (progress.windows == 0 && !is_any_known) return exit_impossible;
    return progress.done == progress.windows ? exit_done : exit_failed;
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("subject", arguments->subject,
                     "SPACECRAFT/EQUIPMENT; without it every equipment of the configuration");
  command.add_option("--config", arguments->config,
                     fmt::format("configuration of the service ({})", default_config_file));
  add_time_options(command, arguments->time, "windows that end");
  command.add_flag("--json", arguments->json,
                   "one JSON object with the counts, also of what waits and of alarms");
  command.footer(
      "Works on the file, so reidentd must not run; it publishes the champions when it starts.\n"
      "Windows that were tried are left out: stopped with Ctrl-C, the same command goes on.\n"
      "Example:\n  reident backfill CBERS-4/BDR --from 2025-01-01 --to 2026-01-01");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"backfill", "Try the windows of telemetry that is archived already, on all cores",
     WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::backfill_verb
