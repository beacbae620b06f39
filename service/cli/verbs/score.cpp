#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/history_access.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/verb.hpp"
#include "service/operations/commands.hpp"
#include "service/review/follow_up.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::score_verb {
namespace {

using identification::Score;
using nlohmann::ordered_json;
using storage::EquipmentName;

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  std::string span = "30d";
  bool json = false;
};

struct Scored {
  EquipmentName equipment;
  std::vector<FollowUp> versions;
};

std::variant<std::vector<Scored>, Refusal> scored(const Readers& readers, const std::string& text,
                                                  Duration span) {
  const auto equipment = find_equipment(readers.history, text);
  if (const auto* refusal = std::get_if<Refusal>(&equipment)) return *refusal;
  std::vector<Scored> all;
  for (const EquipmentName& one : std::get<std::vector<EquipmentName>>(equipment))
    all.push_back({one, follow_up(readers.history, readers.telemetry, one, span)});
  return all;
}

ordered_json errors_json(const Score& score) {
  return {{"mrse_percent", score.mrse()}, {"fit_percent", score.fit()}};
}

void print_json(const std::vector<Scored>& all) {
  ordered_json list = ordered_json::array();
  for (const Scored& one : all)
    for (const FollowUp& version : one.versions) {
      ordered_json row{{"spacecraft", one.equipment.spacecraft},
                       {"equipment", one.equipment.equipment},
                       {"version", version.version},
                       {"begin", time_text(version.range.begin)},
                       {"end", time_text(version.range.end)}};
      if (!version.reason.empty()) {
        row["reason"] = version.reason;
      } else {
        row["rows"] = version.own.rows;
        row["errors"] = errors_json(version.own);
        row["mean"] = errors_json(version.mean);
        row["static_regression"] = errors_json(version.static_regression);
      }
      if (version.replaced != 0) row["replaced"] = version.replaced;
      if (version.before) row["replaced_errors"] = errors_json(*version.before);
      list.push_back(std::move(row));
    }
  fmt::print("{}\n", ordered_json{{"versions", list}}.dump(2, ' ', false,
                                                           ordered_json::error_handler_t::replace));
}

std::string error_text(const Score& score) {
  return fmt::format("{:.3g}", score.mrse());
}

/// What errs less than the version.
std::vector<std::string> better_than(const FollowUp& version) {
  std::vector<std::string> names;
  const auto add = [&](const Score& other, const char* name) {
    if (other.mrse() < version.own.mrse()) names.emplace_back(name);
  };
  if (version.before) add(*version.before, "replaced");
  add(version.mean, "mean");
  add(version.static_regression, "static");
  return names;
}

void print_table(const std::vector<Scored>& all) {
  using enum Table::Align;
  Table table({{"version"},
               {"telemetry from (UTC)"},
               {"for", right},
               {"fit %", right},
               {"MRSE %", right},
               {"replaced", right},
               {"mean", right},
               {"static", right},
               {"errs less"}});
  std::string missing;
  for (const Scored& one : all)
    for (const FollowUp& version : one.versions) {
      const std::string name = fmt::format("{}@{}", full_name(one.equipment), version.version);
      if (!version.reason.empty()) {
        missing += fmt::format("{}: {}\n", name, version.reason);
        continue;
      }
      const storage::TimeRange range = version.range;
      table.add({name, time_text(range.begin), rough_duration_text(range.end - range.begin),
                 fmt::format("{:.3g}", version.own.fit()), error_text(version.own),
                 version.before ? error_text(*version.before) : "-", error_text(version.mean),
                 error_text(version.static_regression), joined(better_than(version))});
    }
  if (!table.empty()) fmt::print("{}", table.text(terminal_width()));
  fmt::print("{}", missing);
  if (table.empty() && missing.empty()) fmt::print("no version was ever approved\n");
}

int run(const Arguments& arguments) {
  const auto span = parse_duration(arguments.span);
  if (!span || *span <= 0)
    return refuse({fmt::format("{} is no length of time; write it as 12h or 30d", arguments.span)});
  return with_readers(arguments.access, [&](const Readers& readers) {
    const auto found = scored(readers, arguments.subject, *span);
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    if (arguments.json)
      print_json(std::get<std::vector<Scored>>(found));
    else
      print_table(std::get<std::vector<Scored>>(found));
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("equipment", arguments->subject,
                     "EQUIPMENT or SPACECRAFT/EQUIPMENT (all of them)");
  command
      .add_option("--span", arguments->span,
                  "the most telemetry behind an approval that is looked at")
      ->capture_default_str();
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Errors are of free runs on the telemetry from a version's approval until the next one, "
      "nothing excluded: of the version, of the one that it replaced, of the outputs' means over "
      "its window, and of a static regression of its window.\n"
      "Example:\n"
      "  reident score CBERS-4/BDR --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"score", "Score every approved version, and what it replaced, on the telemetry after it",
     WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::score_verb
