#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/history_access.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/judgement/scores.hpp"
#include "service/operations/commands.hpp"
#include "service/review/stored_league.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::overview_verb {
namespace {

using nlohmann::ordered_json;
using storage::DecisionKind;
using storage::EquipmentName;

struct Arguments {
  HistoryAccessOptions access;
  bool json = false;
};

struct Line {
  EquipmentName equipment;
  std::int64_t champion = 0;  // 0: none
  storage::Time since = 0;
  ordered_json error_percent,
      simulator_percent;  // on the blocks of the champion's record; null: unknown
  std::optional<Reason> failure;
  std::size_t tried = 0, versions = 0, published = 0;
};

/// Of the champion and of the simulator's own model, on the blocks of its record.
void read_errors(const history::HistoryReader& history, Line& line) {
  const Member champion{line.champion, {}, history.scores(line.equipment, line.champion)};
  Sums own, simulator;
  for (const storage::Block& block : history.blocks(line.equipment)) {
    const storage::BlockScore* score = counts(block) ? find(champion, block.range.begin) : nullptr;
    if (!score) continue;
    own.add(block, score->square);
    if (!block.baseline_square.empty()) simulator.add(block, block.baseline_square);
  }
  if (own.rows > 0) line.error_percent = own.mrse_percent();
  if (simulator.rows > 0) line.simulator_percent = simulator.mrse_percent();
}

Line line_of(const history::HistoryReader& history, const EquipmentName& equipment) {
  Line line;
  line.equipment = equipment;
  storage::HistoryFilter filter;
  filter.spacecraft = equipment.spacecraft;
  filter.equipment = equipment.equipment;
  line.tried = history.attempts(filter).size();
  line.versions = history.summaries(equipment).size();
  const auto decisions = history.decisions(equipment);
  line.published = static_cast<std::size_t>(std::count_if(
      decisions.begin(), decisions.end(),
      [](const storage::Decision& decision) { return decision.kind == DecisionKind::approve; }));
  const auto made = history.champion_decision(equipment);
  if (!made) return line;
  line.champion = made->version;
  line.since = made->time;
  if (const auto attempt = history.attempt(equipment, made->version)) {
    const ordered_json evidence = evidence_of(*attempt);
    line.error_percent = evidence.value("mrse_percent", ordered_json());
    line.simulator_percent = evidence.value("baseline_mrse_percent", ordered_json());
  }
  read_errors(history, line);
  if (const auto attempt = history.attempt(equipment, made->version))
    line.failure = failure_now(history, *attempt, made->version);
  return line;
}

std::string percent_text(const ordered_json& percent) {
  return percent.is_number() ? fmt::format("{:.3g}", percent.get<double>()) : "-";
}

void print_table(const std::vector<Line>& lines) {
  Table table({{"equipment"},
               {"champion", Table::Align::right},
               {"since (UTC)"},
               {"error %", Table::Align::right},
               {"simulator %", Table::Align::right},
               {"tried", Table::Align::right},
               {"published", Table::Align::right}});
  for (const Line& line : lines)
    table.add({full_name(line.equipment),
               line.champion > 0 ? fmt::format("{}", line.champion) : "none",
               line.champion > 0 ? time_text(line.since).substr(0, 16) : "-",
               percent_text(line.error_percent), percent_text(line.simulator_percent),
               fmt::format("{}", line.tried), fmt::format("{}", line.published)});
  fmt::print("{}", table.text(0));
  for (const Line& line : lines)
    if (line.failure) fmt::print("{}: {}\n", full_name(line.equipment), sentence(*line.failure));
}

void print_json(const std::vector<Line>& lines) {
  ordered_json array = ordered_json::array();
  for (const Line& line : lines)
    array.push_back(
        {{"spacecraft", line.equipment.spacecraft},
         {"equipment", line.equipment.equipment},
         {"champion", line.champion > 0 ? ordered_json(line.champion) : ordered_json()},
         {"since", line.champion > 0 ? ordered_json(time_text(line.since)) : ordered_json()},
         {"mrse_percent", line.error_percent},
         {"simulator_mrse_percent", line.simulator_percent},
         {"windows_tried", line.tried},
         {"versions", line.versions},
         {"published", line.published},
         {"failure", line.failure ? to_json({*line.failure}).front() : ordered_json()}});
  const ordered_json object = {{"equipment", array}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  return with_readers(arguments.access, [&](const Readers& readers) {
    std::vector<Line> lines;
    for (const EquipmentName& equipment : readers.history.equipment())
      lines.push_back(line_of(readers.history, equipment));
    if (arguments.json)
      print_json(lines);
    else if (lines.empty())
      fmt::print("no window was tried yet\n");
    else
      print_table(lines);
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "A line for each equipment: the champion and its error on data that it was not fitted to,\n"
      "the error of the simulator's own model there, windows tried and versions published.\n"
      "Example:\n  reident overview --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"overview",
                                   "Show for each equipment its champion, errors and counts",
                                   WorksOn::history, declare});

}  // namespace
}  // namespace reident::cli::overview_verb
