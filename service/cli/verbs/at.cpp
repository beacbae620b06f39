#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/history/telemetry_champion.hpp"
#include "service/model/reasons.hpp"
#include "service/operations/commands.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

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
  bool by_telemetry = false;
  bool json = false;
};

/// An equipment and the decision that made its champion, with the time from which on it was; none
/// where it had no champion.
struct Line {
  EquipmentName equipment;
  std::optional<history::Reign> reign;
  std::optional<history::Reign> first;  // of all, where it had none yet
};

Line line_of(const HistoryReader& history, const EquipmentName& equipment, storage::Time time,
             bool by_telemetry) {
  Line line;
  line.equipment = equipment;
  if (by_telemetry) {
    line.reign = history::champion_for_telemetry(history, equipment, time);
  } else if (auto made = history.champion_decision(equipment, time)) {
    const storage::Time since = made->time;
    line.reign = {*std::move(made), since};
  }
  if (line.reign) return line;
  line.first = history::first_champion(history, equipment);
  if (line.first && !by_telemetry) line.first->from = line.first->decision.time;
  if (line.first && line.first->from <= time) line.first.reset();  // it was withdrawn
  return line;
}

std::variant<std::vector<Line>, Refusal> lines(const HistoryReader& history, storage::Time time,
                                               const std::string& text, bool by_telemetry) {
  const auto equipment = find_equipment(history, text);
  if (const auto* refusal = std::get_if<Refusal>(&equipment)) return *refusal;
  std::vector<Line> found;
  for (const EquipmentName& one : std::get<std::vector<EquipmentName>>(equipment))
    found.push_back(line_of(history, one, time, by_telemetry));
  return found;
}

/// To the second.
std::string second_text(storage::Time time) {
  constexpr storage::Time second = 1'000'000'000;
  return time_text(time - (time % second + second) % second);
}

void print_table(const std::vector<Line>& lines, bool by_telemetry) {
  Table table({{"equipment"},
               {"version", Table::Align::right},
               {by_telemetry ? "for telemetry since (UTC)" : "since (UTC)"},
               {"by"},
               {"what and why"}});
  for (const Line& line : lines) {
    const std::string name = full_name(line.equipment);
    if (line.reign) {
      const Decision& made = line.reign->decision;
      table.add({name, fmt::format("{}", made.version), second_text(line.reign->from), made.actor,
                 fmt::format("{}: {}", past(made.kind), made.reason)});
      continue;
    }
    table.add({name, "-", "-", "-",
               line.first ? fmt::format("no champion yet: the first one, version {}, {} {}",
                                        line.first->decision.version,
                                        by_telemetry ? "is for telemetry since" : "was decided at",
                                        second_text(line.first->from))
                          : "no champion"});
  }
  fmt::print("{}", table.text(terminal_width()));
  const bool is_before_a_first = std::any_of(
      lines.begin(), lines.end(), [](const Line& line) { return line.first.has_value(); });
  if (!by_telemetry && is_before_a_first)
    fmt::print("--telemetry says which version belongs to telemetry of then\n");
}

void print_json(storage::Time time, const std::vector<Line>& lines) {
  ordered_json list = ordered_json::array();
  for (const Line& line : lines) {
    ordered_json champion, first;
    if (line.reign) {
      const Decision& made = line.reign->decision;
      champion = {{"version", made.version},
                  {"since", time_text(line.reign->from)},
                  {"kind", storage::name(made.kind)},
                  {"actor", made.actor},
                  {"reason", made.reason}};
    }
    if (line.first)
      first = {{"version", line.first->decision.version}, {"since", time_text(line.first->from)}};
    list.push_back({{"spacecraft", line.equipment.spacecraft},
                    {"equipment", line.equipment.equipment},
                    {"champion", champion},
                    {"first", first}});
  }
  fmt::print("{}\n", ordered_json{{"time", time_text(time)}, {"equipment", list}}.dump(
                         2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  const auto time = parse_moment(arguments.time, utc_now());
  if (!time)
    return refuse(
        {fmt::format("{} is no time; write it as 2026-03-01T12:00:00Z, in seconds since "
                     "1970, now or -2h (before now)",
                     arguments.time)});
  return with_readers(arguments.access, [&](const Readers& readers) {
    const auto found = lines(readers.history, *time, arguments.subject, arguments.by_telemetry);
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    if (arguments.json)
      print_json(*time, std::get<std::vector<Line>>(found));
    else
      print_table(std::get<std::vector<Line>>(found), arguments.by_telemetry);
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("time", arguments->time, "UTC, seconds since 1970, now, or -2h (before now)")
      ->required();
  command.add_option("equipment", arguments->subject,
                     "EQUIPMENT or SPACECRAFT/EQUIPMENT (all of them)");
  command.add_flag("--telemetry", arguments->by_telemetry,
                   "which version belongs to telemetry of that time, also where it was imported or "
                   "judged later");
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Without --telemetry: which version simulators ran then.\n"
      "Example:\n  reident at 2026-03-01T12:00:00Z CBERS-4/BDR --telemetry --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"at",
                                   "Show which version was champion at a time, and who decided so",
                                   WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::at_verb
