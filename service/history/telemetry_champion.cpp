#include "service/history/telemetry_champion.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "service/model/reasons.hpp"

namespace reident::history {
namespace {

using storage::Decision;
using storage::DecisionKind;
using storage::EquipmentName;
using storage::Time;

/// All decisions with the generation times from which on they count, in the order of recording.
std::vector<Reign> decisions_by_telemetry(const HistoryReader& history,
                                          const EquipmentName& equipment) {
  std::map<std::int64_t, Time> window_ends;
  storage::HistoryFilter versions;
  versions.spacecraft = equipment.spacecraft;
  versions.equipment = equipment.equipment;
  versions.versions_only = true;
  for (const storage::Attempt& attempt : history.attempts(versions))
    window_ends[*attempt.version] = attempt.window.end;
  std::vector<Reign> all;
  Time reached = INT64_MIN;  // by the decisions so far
  for (Decision& decision : history.decisions(equipment)) {
    // Blocks before the window's end may decide, and nobody has the version before that.
    const Time own =
        std::max(judged_until(decision).value_or(reached), window_ends[decision.version]);
    reached = std::max(reached, own);
    all.push_back({std::move(decision), own});
  }
  return all;
}

bool makes_champion(DecisionKind kind) {
  return kind == DecisionKind::approve || kind == DecisionKind::roll_back;
}

/// The last that is for telemetry until `time`; null where there is none.
const Reign* champion_at(const std::vector<Reign>& decisions, Time time) {
  const Reign* champion = nullptr;
  for (const Reign& one : decisions) {
    if (one.from > time) continue;
    if (makes_champion(one.decision.kind))
      champion = &one;
    else if (champion && one.decision.kind == DecisionKind::withdraw &&
             one.decision.version == champion->decision.version)
      champion = nullptr;
  }
  return champion;
}

}  // namespace

std::optional<Reign> champion_for_telemetry(const HistoryReader& history,
                                            const EquipmentName& equipment, Time time) {
  const std::vector<Reign> decisions = decisions_by_telemetry(history, equipment);
  const Reign* champion = champion_at(decisions, time);
  return champion ? std::optional(*champion) : std::nullopt;
}

std::vector<Tenure> tenures(const HistoryReader& history, const EquipmentName& equipment) {
  std::vector<Reign> decisions = decisions_by_telemetry(history, equipment);
  // All others leave the champion as it is.
  std::erase_if(decisions, [](const Reign& one) {
    return !makes_champion(one.decision.kind) && one.decision.kind != DecisionKind::withdraw;
  });
  std::set<Time> times;
  for (const Reign& one : decisions) times.insert(one.from);
  std::vector<Tenure> all;
  for (const Time time : times) {
    const Reign* champion = champion_at(decisions, time);
    const std::int64_t version = champion ? champion->decision.version : 0;
    if (version != (all.empty() ? 0 : all.back().version)) all.push_back({time, version});
  }
  return all;
}

std::optional<Reign> first_champion(const HistoryReader& history, const EquipmentName& equipment) {
  for (Reign& one : decisions_by_telemetry(history, equipment))
    if (makes_champion(one.decision.kind)) return std::move(one);
  return std::nullopt;
}

}  // namespace reident::history
