#include <cstdio>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/operations/commands.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::at_verb {
namespace {

using history::HistoryReader;
using nlohmann::ordered_json;
using storage::Decision;
using storage::EquipmentName;

struct Arguments {
  HistoryAccessOptions access;
  std::string time;
  std::string subject;
  bool json = false;
};

/// An equipment and the decision that made its champion; none where it had no champion.
using Reign = std::pair<EquipmentName, std::optional<Decision>>;

std::variant<std::vector<Reign>, Refusal> reigns(const HistoryReader& history, storage::Time time,
                                                 const std::string& text) {
  Subject wanted;
  if (!text.empty()) {
    const auto parsed = parse_subject(text);
    if (const auto* refusal = std::get_if<Refusal>(&parsed)) return *refusal;
    wanted = std::get<Subject>(parsed);
    if (wanted.version) return Refusal{text + " names a version; name the equipment alone"};
  }
  std::vector<Reign> found;
  for (const EquipmentName& one : history.equipment())
    if ((wanted.equipment.empty() || one.equipment == wanted.equipment) &&
        (wanted.spacecraft.empty() || one.spacecraft == wanted.spacecraft))
      found.emplace_back(one, history.champion_decision(one, time));
  if (!found.empty()) return found;
  return Refusal{fmt::format("nothing is known about {}; the database has {}",
                             text.empty() ? "any equipment" : text, equipment_in(history))};
}

void print_table(const std::vector<Reign>& reigns) {
  Table table(
      {{"equipment"}, {"version", Table::Align::right}, {"since (UTC)"}, {"by"}, {"what and why"}});
  for (const auto& [equipment, made] : reigns) {
    const std::string name = full_name(equipment);
    if (made)
      table.add({name, fmt::format("{}", made->version), time_text(made->time), made->actor,
                 fmt::format("{}: {}", storage::name(made->kind), made->reason)});
    else
      table.add({name, "-", "-", "-", "no champion"});
  }
  fmt::print("{}", table.text(terminal_width()));
}

void print_json(storage::Time time, const std::vector<Reign>& reigns) {
  ordered_json list = ordered_json::array();
  for (const auto& [equipment, made] : reigns) {
    ordered_json champion;
    if (made)
      champion = {{"version", made->version},
                  {"since", time_text(made->time)},
                  {"kind", storage::name(made->kind)},
                  {"actor", made->actor},
                  {"reason", made->reason}};
    list.push_back({{"spacecraft", equipment.spacecraft},
                    {"equipment", equipment.equipment},
                    {"champion", champion}});
  }
  fmt::print("{}\n", ordered_json{{"time", time_text(time)}, {"equipment", list}}.dump(
                         2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  const auto time = parse_time(arguments.time);
  if (!time)
    return refuse(
        {fmt::format("{} is no time; write it as 2026-03-01T12:00:00Z or in seconds since "
                     "1970",
                     arguments.time)});
  return with_readers(arguments.access, [&](const Readers& readers) {
    const auto found = reigns(readers.history, *time, arguments.subject);
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    if (arguments.json)
      print_json(*time, std::get<std::vector<Reign>>(found));
    else
      print_table(std::get<std::vector<Reign>>(found));
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("time", arguments->time, "UTC, or seconds since 1970")->required();
  command.add_option("equipment", arguments->subject,
                     "EQUIPMENT or SPACECRAFT/EQUIPMENT (all of them)");
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer("Example:\n  reident at 2026-03-01T12:00:00Z CBERS-4/BDR --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"at",
                                   "Show which version was champion at a time, and who decided so",
                                   WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::at_verb
