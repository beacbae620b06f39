#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/replace_option.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/config/fleet_table.hpp"
#include "service/fleet/helm_values.hpp"
#include "service/fleet/instances.hpp"
#include "service/fleet/site_files.hpp"
#include "service/support/output_file.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli::fleet_verb {
namespace {

using fleet::Instance;
using nlohmann::ordered_json;

constexpr std::size_t rows_of_screen = 20;
constexpr std::size_t lines_of_screen = 22;       // with the title, without the lines behind
constexpr std::size_t most_without_network = 14;  // a source and a console have to join too

struct Arguments {
  std::string table, host, helm, root = "/";
  std::string folder = "/etc/reident";
  bool dry_run = false, replace = false, all = false, json = false;
};

void print_command(const char* command, const std::vector<std::string>& names) {
  if (names.empty()) return;
  fmt::print("{}", command);
  for (const std::string& name : names) fmt::print(" reidentd@{}", name);
  fmt::print("\n");
}

int init(const Arguments& arguments) {
  const auto loaded = load_fleet(arguments.table);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded)) {
    for (const ConfigMistake& mistake : *mistakes)
      print_error("{}", mistake_text(arguments.table, mistake));
    return exit_impossible;
  }
  const auto& table = std::get<Fleet>(loaded);
  if (!arguments.helm.empty()) {
    if (const auto refusal = exists_already(arguments.helm, arguments.replace))
      return refuse(*refusal);
    OutputFile output(arguments.helm);
    output.write(fleet::helm_values(table));
    output.finish();
    fmt::print("{} instances\nnext: helm install reident deploy/container/chart -f {}\n",
               table.instances.size(), arguments.helm);
    return exit_done;
  }
  const auto files = fleet::site_files(table, arguments.host);
  if (arguments.dry_run) {
    for (const auto& [path, text] : files)
      fmt::print("==> {}\n{}\n", (arguments.root / path).string(), text);
    fmt::print("{} instances, {} files, none written\n", table.instances.size(), files.size());
    return exit_done;
  }
  const fleet::SiteChange change = fleet::change_of(files, arguments.root);
  fleet::write_site_files(files, change, arguments.root);
  std::vector<std::string> names;
  std::set<std::string> hosts;
  for (const FleetInstance& one : table.instances) {
    hosts.insert(one.host);
    if (arguments.host.empty() || one.host == arguments.host) names.push_back(one.name);
  }
  fmt::print("{} instances, {} files\n", names.size(), files.size());
  print_command("next: systemctl daemon-reload && systemctl enable --now", names);
  print_command("changed, where they run: systemctl restart", change.changed);
  print_command("no longer in the table, and left as they are: systemctl disable --now",
                change.gone);
  for (const std::string& name : change.gone)
    fmt::print(
        "  then remove {0}/etc/reident/{1}.toml, {0}/etc/systemd/system/reidentd@{1}.service.d, "
        "and {1}.xml and {1}-clients.xml of {0}/etc/reident/cyclonedds where they are; telemetry "
        "and models stay in the database\n",
        arguments.root == "/" ? "" : arguments.root, name);
  for (const auto& path : change.stale)
    fmt::print("removed, since the table has it no more: {}\n", (arguments.root / path).string());
  if (arguments.host.empty() && hosts.size() > 1)
    fmt::print(
        "the table has services of {} machines: on each, --host ADDRESS makes its own "
        "alone\n",
        hosts.size());
  if (!table.network && names.size() > most_without_network)
    print_error(
        "reident: without [fleet.network] a domain has room for 16 services, sources and "
        "consoles on a machine, and {} services are too many: add [fleet.network] with "
        "host = \"127.0.0.1\", and run this again",
        names.size());
  return exit_done;
}

std::string service_of(const Instance& instance) {
  if (!instance.has_service) return "?";
  return *instance.has_service ? "runs" : "none";
}

std::string table_text(const std::vector<Instance>& instances, std::size_t shown) {
  constexpr auto right = Table::Align::right;
  Table table({{"instance"},
               {"service"},
               {"models", right},
               {"waiting", right},
               {"alarms", right},
               {"telemetry", right},
               {"worst"}});
  const storage::Time now = utc_now();
  for (std::size_t i = 0; i < shown; ++i) {
    const Instance& one = instances[i];
    const auto telemetry = one.oldest_telemetry();
    table.add(
        {one.name, service_of(one), fmt::format("{}/{}", one.with_champion(), one.rows.size()),
         fmt::format("{}", one.waiting()), fmt::format("{}", one.unseen_alarms()),
         telemetry ? rough_duration_text(now - *telemetry) : "-", one.note()},
        shows_colours() && one.needs_action() ? Table::Look::urgent : Table::Look::plain);
  }
  return table.text(terminal_width());
}

/// As a terminal shows it, which breaks what is too wide.
std::size_t lines_of(std::string_view text) {
  const std::size_t width = terminal_width();
  std::size_t lines = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t columns = display_width(text.substr(begin, end - begin));
    lines += width == 0 || columns == 0 ? 1 : (columns + width - 1) / width;
    begin = end + 1;
  }
  return lines;
}

void print_table(const std::vector<Instance>& instances, bool all) {
  std::size_t shown = all ? instances.size() : std::min(rows_of_screen, instances.size());
  std::string text = table_text(instances, shown);
  // Where a text goes over several lines, less of them is a screen.
  while (!all && shown > 1 && lines_of(text) > lines_of_screen)
    text = table_text(instances, --shown);
  fmt::print("{}", text);
  const auto act = std::ranges::count_if(instances, &Instance::needs_action);
  fmt::print("{}{} instances, {} need somebody\n",
             shown < instances.size()
                 ? fmt::format("and {} more; --all lists them\n", instances.size() - shown)
                 : "",
             instances.size(), act);
}

void print_json(const std::vector<Instance>& instances) {
  ordered_json list = ordered_json::array();
  for (const Instance& one : instances) {
    const auto telemetry = one.oldest_telemetry();
    ordered_json alarms = ordered_json::array();
    for (const storage::Alarm& alarm : one.alarms) alarms.push_back(alarm_json(alarm));
    list.push_back({{"instance", one.name},
                    {"act", one.needs_action()},
                    {"of_site", one.is_of_site},
                    {"problem", text_json(one.problem)},
                    {"service", one.has_service ? ordered_json(*one.has_service) : ordered_json()},
                    {"equipment", one.rows.size()},
                    {"with_champion", one.with_champion()},
                    {"waiting", one.waiting()},
                    {"page", text_json(one.page)},
                    {"telemetry", telemetry ? ordered_json(time_text(*telemetry)) : ordered_json()},
                    {"alarms", alarms}});
  }
  fmt::print("{}\n", ordered_json({{"instances", list}})
                         .dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

int status(const Arguments& arguments) {
  WorkerPool workers(usable_cores());
  const std::vector<Instance> instances = fleet::read_instances(arguments.folder, workers);
  if (arguments.json)
    print_json(instances);
  else
    print_table(instances, arguments.all);
  return std::ranges::any_of(instances, &Instance::needs_action) ? exit_failed : exit_done;
}

int refusing(const std::function<int()>& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    return refuse({error.what()});
  }
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.require_subcommand(1);
  CLI::App* make = command.add_subcommand(
      "init", "Write the configurations, the units' drop-ins and the targets of a table");
  make->add_option("table", arguments->table, "spacecraft, as in deploy/fleet.toml")->required();
  make->add_option("--host", arguments->host,
                   "only the services of this machine, as the table has its address");
  make->add_option("--root", arguments->root, "folder that the files are written below")
      ->capture_default_str();
  make->add_flag("--dry-run", arguments->dry_run, "print the files, and write nothing");
  make->add_option("--helm", arguments->helm,
                   "write the values of the Helm chart deploy/container/chart, and nothing else")
      ->type_name("FILE")
      ->excludes("--root")
      ->excludes("--host")
      ->excludes("--dry-run");
  add_replace_option(*make, arguments->replace);
  make->get_option("--replace")->needs("--helm");
  CLI::App* show =
      command.add_subcommand("status", "Show how the instances of this machine are, worst first");
  show->add_option("folder", arguments->folder, "where the configurations are, one an instance")
      ->capture_default_str();
  show->add_flag("--all", arguments->all, "more than a screen");
  show->add_flag("--json", arguments->json, "one JSON object with all instances");
  for (CLI::App* one : {make, show}) one->group("Commands");
  command.footer(
      "Example:\n  reident fleet init fleet.toml --dry-run\n  reident fleet status /etc/reident\n"
      "Exit status of status: 0 when all is well; 1 when somebody has to act.");
  return [arguments, make] {
    return refusing([&] { return make->parsed() ? init(*arguments) : status(*arguments); });
  };
}

const VerbRegistration registered(
    {"fleet", "Make the services of many spacecraft from one table, and show how all are",
     WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::fleet_verb
