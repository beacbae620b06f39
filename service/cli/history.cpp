#include <cstdio>
#include <set>

#include <fmt/format.h>

#include "service/cli/stored.hpp"
#include "service/cli/table.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

using nlohmann::ordered_json;
using storage::Attempt;
using storage::HistoryFilter;
using storage::Registry;

struct Arguments {
  DatabaseOptions database;
  std::string spacecraft;
  std::string equipment;
  std::optional<std::size_t> last;
  bool versions_only = false;
  bool json = false;
};

/// Tells the version that runs now from the others.
class Champions {
 public:
  explicit Champions(const Registry& registry) {
    for (const storage::Version& version : registry.champions())
      champions_.insert({version.spacecraft, version.equipment, version.number});
  }
  bool contains(const Attempt& attempt) const {
    return attempt.version &&
           champions_.contains({attempt.spacecraft, attempt.equipment, *attempt.version});
  }

 private:
  std::set<std::tuple<std::string, std::string, std::int64_t>> champions_;
};

std::string version_text(const Attempt& attempt, bool champion) {
  if (!attempt.version) return "-";
  return fmt::format("{}{}", *attempt.version, champion ? "*" : "");
}

void print_table(const std::vector<Attempt>& attempts, const Champions& champions) {
  Table table({{"equipment"},
               {"window (UTC)"},
               {"length"},
               {"version", Table::Align::right},
               {"order", Table::Align::right},
               {"MRSE %", Table::Align::right},
               {"fit %", Table::Align::right},
               {"outcome and reason"}});
  for (const Attempt& attempt : attempts) {
    const ordered_json evidence = evidence_of(attempt);
    table.add({full_name(attempt.spacecraft, attempt.equipment), time_text(attempt.window.begin),
               duration_text(attempt.window.end - attempt.window.begin),
               version_text(attempt, champions.contains(attempt)),
               evidence_number(evidence, "order"), evidence_number(evidence, "mrse_percent"),
               evidence_number(evidence, "fit_percent"),
               fmt::format("{}: {}", attempt.outcome, attempt.reason)});
  }
  fmt::print("{}", table.text(terminal_width()));
  fmt::print("* champion: what simulators run now\n");
}

void print_json(const std::vector<Attempt>& attempts, const Champions& champions) {
  ordered_json list = ordered_json::array();
  for (const Attempt& attempt : attempts) {
    const ordered_json evidence = evidence_of(attempt);
    const auto number = [&](const char* key) { return evidence.value(key, ordered_json()); };
    list.push_back(
        {{"attempt", attempt.id},
         {"spacecraft", attempt.spacecraft},
         {"equipment", attempt.equipment},
         {"window",
          {{"begin", time_text(attempt.window.begin)}, {"end", time_text(attempt.window.end)}}},
         {"trigger", attempt.trigger},
         {"time", time_text(attempt.time)},
         {"outcome", attempt.outcome},
         {"reason", attempt.reason},
         {"version", attempt.version ? ordered_json(*attempt.version) : ordered_json()},
         {"champion", champions.contains(attempt)},
         {"order", number("order")},
         {"mrse_percent", number("mrse_percent")},
         {"fit_percent", number("fit_percent")},
         {"evidence", evidence},
         {"configuration_digest", attempt.configuration_digest},
         {"program_version", attempt.program_version}});
  }
  fmt::print("{}\n", ordered_json{{"attempts", list}}.dump(2, ' ', false,
                                                           ordered_json::error_handler_t::replace));
}

/// Why a filter selects nothing.
Refusal nothing_selected(const Arguments& arguments, const Registry& registry) {
  HistoryFilter newest;
  newest.last = 1;
  if (registry.attempts(newest).empty())
    return {"no window has been tried yet; reident status shows what the service does"};
  const auto or_any = [](const std::string& name) { return name.empty() ? "(any)" : name; };
  return {fmt::format("no {} of {}; the database has {}",
                      arguments.versions_only ? "version" : "attempt",
                      full_name(or_any(arguments.spacecraft), or_any(arguments.equipment)),
                      equipment_in(registry))};
}

int run(const Arguments& arguments) {
  return with_registry(arguments.database, [&](const Registry& registry) {
    HistoryFilter filter;
    filter.spacecraft = arguments.spacecraft;
    filter.equipment = arguments.equipment;
    filter.versions_only = arguments.versions_only;
    filter.last = arguments.last;
    const std::vector<Attempt> attempts = registry.attempts(filter);
    const bool filtered = !arguments.spacecraft.empty() || !arguments.equipment.empty();
    if (attempts.empty() && (filtered || !arguments.json))
      return refuse(nothing_selected(arguments, registry));
    const Champions champions(registry);
    if (arguments.json)
      print_json(attempts, champions);
    else
      print_table(attempts, champions);
    return static_cast<int>(exit_done);
  });
}

}  // namespace

void add_history(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "history", "List every window that was tried, what came out and why, the latest last");
  add_database_options(*command, arguments->database);
  command->add_option("--spacecraft", arguments->spacecraft, "of this spacecraft alone");
  command->add_option("--equipment", arguments->equipment, "of this equipment alone");
  command->add_option("--last", arguments->last, "the newest so many")->check(CLI::PositiveNumber);
  command->add_flag("--versions-only", arguments->versions_only,
                    "leave out windows that gave no model");
  command->add_flag("--json", arguments->json, "one JSON object with all evidence");
  command->footer("Example:\n  reident history --config reident.toml --equipment BDR --last 20");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace reident::cli
