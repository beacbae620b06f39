// What approved versions erred on the telemetry after them, and what else could have run there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "identification/simulation/scores.hpp"
#include "service/config/config.hpp"
#include "service/history/readers.hpp"

namespace reident {

/// A champion on the telemetry from its approval until the next one's. Errors are of free runs.
struct FollowUp {
  std::int64_t version = 0;
  std::int64_t replaced = 0;                    // the champion before; 0: none
  storage::TimeRange range;                     // generation times
  std::string reason;                           // why there are no errors; empty: there are
  identification::Score own;                    // of the version
  std::optional<identification::Score> before;  // of the one that it replaced, on the same rows
  identification::Score mean;                   // of the outputs' means over its window
  identification::Score static_regression;      // of the outputs on the inputs in its window
};

/// Every champion that telemetry follows, ascending by time. Nothing is excluded from the
/// telemetry, of which at most `span` behind an approval is looked at. Throws as the readers.
std::vector<FollowUp> follow_up(const history::HistoryReader& history,
                                const history::TelemetryReader& telemetry,
                                const storage::EquipmentName& equipment, Duration span);

}  // namespace reident
