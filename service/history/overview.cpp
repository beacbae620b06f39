#include "service/history/overview.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "service/history/model_parameters.hpp"
#include "service/judgement/scores.hpp"
#include "service/model/model_json.hpp"
#include "service/operations/commands.hpp"
#include "storage/archive/holdings.hpp"
#include "storage/database/snapshot.hpp"

namespace reident::history {
namespace {

using storage::EquipmentName;
using storage::Registry;

/// Blocks over which an error of now is taken, and those that are looked at to find so many.
constexpr std::size_t blocks_of_now = 2 * blocks_of_cycle;
constexpr std::size_t blocks_looked_at = 4 * blocks_of_now;

/// The newest samples of a spacecraft's parameters, by name.
using Newest = std::map<std::pair<std::string, std::string>, storage::Time>;

Newest newest_samples(const storage::Database& database) {
  Newest newest;
  for (const storage::SeriesInfo& series : storage::all_series(database))
    if (series.origin == storage::Origin::real)
      newest[{series.spacecraft, series.name}] = series.last;
  return newest;
}

std::optional<double> percent_in(const std::string& json, const char* key) {
  const auto evidence = nlohmann::json::parse(json, nullptr, false);
  if (!evidence.is_object() || !evidence.contains(key) || !evidence[key].is_number())
    return std::nullopt;
  return evidence[key].get<double>();
}

/// Errors of the champion, by its record, and of the simulator's own model over the last cycles.
void read_errors(const Registry& registry, storage::Time record, OverviewRow& row) {
  const std::vector<storage::Block> blocks = registry.newest_blocks(row.name, blocks_looked_at);
  if (blocks.empty()) return;
  const std::vector<storage::BlockScore> scores =
      registry.scores(row.name.spacecraft, row.name.equipment, row.champion,
                      std::max(record, blocks.front().range.begin));
  Sums own, simulator;
  std::size_t taken = 0;
  for (auto block = blocks.rbegin(); block != blocks.rend() && taken < blocks_of_now; ++block) {
    const storage::BlockScore* score = counts(*block) ? find(scores, block->range.begin) : nullptr;
    if (!score) continue;
    ++taken;
    own.add(*block, score->square);
    if (!block->baseline_square.empty()) simulator.add(*block, block->baseline_square);
  }
  if (own.rows > 0) row.error_percent = own.mrse_percent();
  if (simulator.rows > 0) row.simulator_percent = simulator.mrse_percent();
}

/// The time until which every parameter has samples; absent where one has none.
std::optional<storage::Time> complete_until(const std::string& spacecraft,
                                            const std::vector<std::string>& parameters,
                                            const Newest& newest) {
  std::optional<storage::Time> until;
  for (const std::string& name : parameters) {
    const auto found = newest.find({spacecraft, name});
    if (found == newest.end()) return std::nullopt;
    until = std::min(until.value_or(found->second), found->second);
  }
  return until;
}

void read_champion(const Registry& registry, const storage::Decision& made, const Newest& newest,
                   OverviewRow& row) {
  row.champion = made.version;
  row.since = made.time;
  row.approved_error_percent = error_when_approved(registry, made);
  const auto version = registry.version(row.name.spacecraft, row.name.equipment, made.version);
  if (!version) return;
  storage::Time record = version->window.end;
  try {
    record = equipment_model_from_json(version->model_json).validated_on.begin;
    row.telemetry = complete_until(row.name.spacecraft, parameters_of(version->model_json), newest);
  } catch (const std::exception&) {  // damaged: nothing is known of the model, verify says it
  }
  read_errors(registry, record, row);
  const auto change = registry.last_change(row.name);
  if (change && change->champion == made.version) row.change = change;
}

OverviewRow row_of_equipment(const Registry& registry, const EquipmentName& name,
                             const Newest& newest) {
  OverviewRow row;
  row.name = name;
  const Registry::Counts counts = registry.counts(name);
  row.attempts = counts.attempts;
  row.versions = counts.versions;
  row.approvals = counts.approvals;
  row.hold = registry.hold(name.spacecraft, name.equipment);
  if (const auto made = registry.champion_decision(name.spacecraft, name.equipment))
    read_champion(registry, *made, newest, row);
  return row;
}

}  // namespace

std::optional<double> error_when_approved(const Registry& registry, const storage::Decision& made) {
  const auto decisions = registry.decisions(made.spacecraft, made.equipment, made.version);
  for (auto one = decisions.rbegin(); one != decisions.rend(); ++one)
    if (one->id <= made.id)
      if (const auto error = percent_in(one->evidence_json, "mrse_percent")) return error;
  const auto version = registry.version(made.spacecraft, made.equipment, made.version);
  const auto attempt = version ? registry.attempt(version->attempt) : std::nullopt;
  return attempt ? percent_in(attempt->evidence_json, "mrse_percent") : std::nullopt;
}

std::vector<OverviewRow> overview(storage::Database& database) {
  const storage::Snapshot snapshot(database);
  const Registry registry(database);
  const Newest newest = newest_samples(database);
  std::map<EquipmentName, OverviewRow> rows;
  for (const EquipmentName& name : registry.equipment())
    rows.emplace(name, row_of_equipment(registry, name, newest));
  for (const WaitingRow& one : waiting(registry))
    rows[{one.decision.spacecraft, one.decision.equipment}].waiting.push_back(one.decision.version);
  for (const storage::SimulatorState& simulator : registry.simulators()) {
    const auto found = rows.find(simulator.equipment);
    if (found == rows.end() || simulator.version == 0) continue;
    ++found->second.simulators;
    found->second.current += simulator.version == found->second.champion;
  }
  std::vector<OverviewRow> all;
  for (auto& [name, row] : rows) all.push_back(std::move(row));
  return all;
}

std::vector<WaitingRow> waiting(const Registry& registry) {
  std::vector<WaitingRow> rows;
  for (storage::Decision& decision : waiting_for_operator(registry)) {
    WaitingRow row;
    if (const auto version =
            registry.version(decision.spacecraft, decision.equipment, decision.version))
      row.window = version->window;
    for (const WaitingRow& before : rows)
      if (supersedes(decision, before.decision)) row.supersedes.push_back(before.decision.version);
    row.decision = std::move(decision);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace reident::history
