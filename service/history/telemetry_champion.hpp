// Which version belongs to telemetry of a time, whenever that was archived and judged.
#pragma once

#include <optional>

#include "service/history/readers.hpp"

namespace reident::history {

/// A champion by generation times.
struct Reign {
  storage::Decision decision;  // that made it champion
  storage::Time from = 0;      // generation time from which on it is
};

/// The champion for telemetry of the generation time `time`: the last that was decided on telemetry
/// until then. Backfill decides years later, and on the same telemetry. An operator's decision
/// counts from where the gate had come to. Absent where there was none yet. Throws as the reader.
std::optional<Reign> champion_for_telemetry(const HistoryReader& history,
                                            const storage::EquipmentName& equipment,
                                            storage::Time time);

/// The first champion, by generation times; absent where there never was one.
std::optional<Reign> first_champion(const HistoryReader& history,
                                    const storage::EquipmentName& equipment);

/// Who was champion for telemetry from a generation time on.
struct Tenure {
  storage::Time from = 0;
  std::int64_t version = 0;  // 0: none
};

/// Every change of the champion, ascending by generation time. champion_for_telemetry() gives the
/// same version at each time.
std::vector<Tenure> tenures(const HistoryReader& history, const storage::EquipmentName& equipment);

}  // namespace reident::history
