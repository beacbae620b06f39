#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/history_access.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/review/verdict.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli::waiting_verb {
namespace {

using history::WaitingRow;
using nlohmann::ordered_json;

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  bool json = false;
};

storage::EquipmentName name_of(const WaitingRow& row) {
  return {row.decision.spacecraft, row.decision.equipment};
}

std::string numbers_text(const std::vector<std::int64_t>& numbers) {
  constexpr std::size_t shown = 3;
  std::vector<std::string> texts;
  for (const std::int64_t number : numbers)
    if (texts.size() < shown) texts.push_back(std::to_string(number));
  if (texts.empty()) return "-";
  const std::size_t more = numbers.size() - texts.size();
  return joined(texts) + (more > 0 ? fmt::format(" and {} more", more) : "");
}

/// A version that waits, and what speaks for it and against it now.
struct Waiting {
  WaitingRow row;
  Verdict verdict;
};

void print_table(const std::vector<Waiting>& list) {
  constexpr auto right = Table::Align::right;
  Table table({{"version"},
               {"since", right},
               {"error %", right},
               {"champion's %", right},
               {"supersedes"},
               {"why it waits"}});
  const storage::Time now = utc_now();
  for (const auto& [row, verdict] : list) {
    const ordered_json then = evidence_of(row.decision);
    const auto error = [&](const char* key, double Finding::*figure) {
      if (!verdict.now) return evidence_number(then, key);
      return verdict.now->blocks > 0 ? fmt::format("{:.4g}", (*verdict.now).*figure) : "-";
    };
    const bool has_rival = verdict.now || then.contains("champion");  // a first version has none
    table.add({fmt::format("{}@{}", full_name(name_of(row)), row.decision.version),
               rough_duration_text(now - row.decision.time),
               error("mrse_percent", &Finding::mrse_percent),
               has_rival ? error("champion_mrse_percent", &Finding::champion_mrse_percent) : "-",
               numbers_text(row.supersedes), verdict.sentence});
  }
  fmt::print("{}", table.text(terminal_width()));
  fmt::print("'reident why VERSION' shows its record, 'reident approve' and 'reject' answer it.\n");
}

void print_json(const std::vector<Waiting>& waiting) {
  ordered_json list = ordered_json::array();
  for (const auto& [row, verdict] : waiting)
    list.push_back(
        {{"spacecraft", row.decision.spacecraft},
         {"equipment", row.decision.equipment},
         {"version", row.decision.version},
         {"since", time_text(row.decision.time)},
         {"window", {{"begin", time_text(row.window.begin)}, {"end", time_text(row.window.end)}}},
         {"supersedes", row.supersedes},
         {"verdict", verdict.sentence},
         {"reason", row.decision.reason},
         {"evidence", ordered_json::parse(row.decision.evidence_json, nullptr, false)}});
  for (ordered_json& row : list)
    if (row["evidence"].is_discarded()) row["evidence"] = nullptr;
  fmt::print("{}\n", ordered_json{{"waiting", std::move(list)}}.dump(
                         2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  Subject wanted;
  if (!arguments.subject.empty()) {
    const auto parsed = parse_subject(arguments.subject);
    if (const auto* refusal = std::get_if<Refusal>(&parsed)) return refuse(*refusal);
    wanted = std::get<Subject>(parsed);
  }
  return with_readers(arguments.access, [&](const Readers& readers) {
    std::vector<WaitingRow> rows = readers.history.waiting();
    std::erase_if(rows, [&](const WaitingRow& row) {
      return (!wanted.equipment.empty() && row.decision.equipment != wanted.equipment) ||
             (!wanted.spacecraft.empty() && row.decision.spacecraft != wanted.spacecraft);
    });
    std::vector<Waiting> waiting;
    for (WaitingRow& row : rows)
      if (const auto story = stored_version(readers.history, name_of(row), row.decision.version))
        waiting.push_back({std::move(row), verdict_of(readers.history, *story)});
    if (arguments.json)
      print_json(waiting);
    else if (waiting.empty())
      fmt::print("no version waits for an operator\n");
    else
      print_table(waiting);
    return static_cast<int>(waiting.empty() ? exit_done : exit_failed);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("equipment", arguments->subject,
                     "EQUIPMENT or SPACECRAFT/EQUIPMENT (every one)");
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "The errors are those of the version and of the champion on the blocks that both were scored "
      "on since the last change of the equipment.\n"
      "Versions that wait for telemetry are not listed: 'reident history' has them. To approve a "
      "version rejects those that it supersedes: earlier ones of its equipment that wait too.\n"
      "Example:\n"
      "  reident waiting --config reident.toml\n"
      "Exit status: 0 when none waits, 1 when one does.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"waiting",
                                   "List the versions that wait for an operator, and why",
                                   WorksOn::history, declare});

}  // namespace
}  // namespace reident::cli::waiting_verb
