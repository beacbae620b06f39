#include "service/cli/output/simulator_list.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

std::string second_text(storage::Time time) {
  constexpr storage::Time second = 1'000'000'000;
  return time_text(time / second * second);
}

SimulatorState state_of(const ModelAcknowledgement& said,
                        const std::optional<PublishedVersion>& champion, bool has_service) {
  const RunningModel& running = said.running;
  if (running.version == 0) return SimulatorState::not_running;
  if (!has_service) return running.from_cache ? SimulatorState::from_file : SimulatorState::unknown;
  if (!champion) return SimulatorState::unpublished;
  if (running.version < champion->number) return SimulatorState::old;
  if (running.version > champion->number) return SimulatorState::rolled_back;
  // The digest of a refused version says nothing about the one that runs.
  const bool is_known = said.accepted && !said.digest.empty() && !champion->digest.empty();
  return is_known && said.digest != champion->digest ? SimulatorState::different
                                                     : SimulatorState::current;
}

std::string words(SimulatorState state, const RunningModel& running,
                  const std::optional<PublishedVersion>& champion) {
  switch (state) {
    case SimulatorState::current:
      return "current";
    case SimulatorState::old: {
      const std::int64_t behind = champion->number - running.version;
      return fmt::format("old by {} version{}: {} is out since {}", behind, behind == 1 ? "" : "s",
                         champion->number, second_text(champion->decided));
    }
    case SimulatorState::rolled_back:
      return fmt::format("newer than the champion: {} is out since {}", champion->number,
                         second_text(champion->decided));
    case SimulatorState::different:
      return "another content than the champion's; do two services publish it?";
    case SimulatorState::unpublished:
      return "no champion: what runs is no longer published";
    case SimulatorState::from_file:
      return fmt::format("from file, approved {}", second_text(running.decided));
    case SimulatorState::unknown:
      return "champion not known";
    case SimulatorState::not_running:
      return "not running";
  }
  return {};
}

}  // namespace

const char* name(SimulatorState state) {
  switch (state) {
    case SimulatorState::current:
      return "current";
    case SimulatorState::old:
      return "old";
    case SimulatorState::rolled_back:
      return "rolled_back";
    case SimulatorState::different:
      return "different";
    case SimulatorState::unpublished:
      return "unpublished";
    case SimulatorState::from_file:
      return "from_file";
    case SimulatorState::unknown:
      return "unknown";
    case SimulatorState::not_running:
      return "not_running";
  }
  return "";
}

bool SimulatorRow::is_old() const {
  return state == SimulatorState::old || state == SimulatorState::rolled_back ||
         state == SimulatorState::different || state == SimulatorState::unpublished;
}

std::string SimulatorRow::text() const {
  std::string text = words(state, said.running, champion);
  if (said.running.from_cache && state != SimulatorState::from_file)
    text += fmt::format("; from file, approved {}", second_text(said.running.decided));
  if (said.running.offered_version > 0)
    text += fmt::format("; offered {}: other signals", said.running.offered_version);
  if (!said.accepted) text += fmt::format("; refused {}: {}", said.version, said.reason);
  return text;
}

std::vector<SimulatorRow> list_simulators(const PartitionSurvey& sight,
                                          const storage::EquipmentName& wanted) {
  std::vector<SimulatorRow> rows;
  for (const ModelAcknowledgement& said : sight.simulators) {
    if ((!wanted.spacecraft.empty() && said.spacecraft != wanted.spacecraft) ||
        (!wanted.equipment.empty() && said.equipment != wanted.equipment))
      continue;
    if (!sight.spacecraft.empty() && !sight.spacecraft.contains(said.spacecraft)) continue;
    SimulatorRow row{said, std::nullopt, SimulatorState::unknown};
    const auto champion = sight.champions.find({said.spacecraft, said.equipment});
    if (champion != sight.champions.end()) row.champion = champion->second;
    row.state = state_of(said, row.champion, sight.services > 0);
    rows.push_back(std::move(row));
  }
  std::sort(rows.begin(), rows.end(), [](const SimulatorRow& a, const SimulatorRow& b) {
    return std::tie(a.said.simulator, a.said.spacecraft, a.said.equipment) <
           std::tie(b.said.simulator, b.said.spacecraft, b.said.equipment);
  });
  return rows;
}

}  // namespace reident::cli
