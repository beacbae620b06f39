// Windows of the past: slides over telemetry that is in the archive already, on all cores.
//
// What takes long (identification) is done for several windows side by side; then they are judged
// one after the other, oldest first, each against the champion of the windows before it. The result
// is that of the daemon, had it listened then, and does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/support/parallel.hpp"
#include "service/windows/found_window.hpp"
#include "storage/archive/archive.hpp"
#include "storage/database/database.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

/// Which windows.
struct BackfillRequest {
  std::string spacecraft;    // empty: every one of the configuration
  std::string equipment;     // empty: every one
  storage::TimeRange range;  // of the windows' ends
  /// What was found in a window already; may be empty. Several threads call it at the same time.
  std::function<std::optional<FoundWindow>(const RefreshRequest&)> found{};
};

/// How far it is.
struct BackfillProgress {
  std::size_t windows = 0;   // in all
  std::size_t done = 0;      // of these
  std::size_t approved = 0;  // versions, those that were confirmed included
  std::string equipment;     // at work
  storage::Time window_end = 0;
};

/// Returns the ends in `range`, ascending, of the equipment's windows whose last slide holds a new
/// sample and whose end telemetry has reached.
std::vector<storage::Time> window_ends(const storage::Archive& archive,
                                       const std::string& spacecraft,
                                       const EquipmentConfig& equipment, storage::TimeRange range);

/// Tries every window of window_ends() that was never tried, and records each in `database`, which
/// is open for writing. Telemetry is that of the configuration's file, which threads open again for
/// reading; where `database` is another one, that file is only read. `clock` gives the time of each
/// record; its argument is the time that telemetry had reached. After each window `report` is
/// called; false stops, and the next call goes on from there. Returns the progress at the end.
/// Throws storage::Error, and what `found` throws.
BackfillProgress backfill(storage::Database& database, const Config& config,
                          const BackfillRequest& request, WorkerPool& workers,
                          const std::function<storage::Time(storage::Time)>& clock,
                          const std::function<bool(const BackfillProgress&)>& report);

}  // namespace reident
