// Windows of the past: slides over telemetry that is in the archive already, on all cores.
//
// What takes long (identification) is done for several windows side by side; then they are judged
// one after the other, oldest first, each against the champion of the windows before it. The result
// is that of the daemon, had it listened then, and does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "service/config/config.hpp"
#include "service/support/parallel.hpp"
#include "storage/database/database.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

/// Which windows.
struct BackfillRequest {
  std::string spacecraft;    // empty: every one of the configuration
  std::string equipment;     // empty: every one
  storage::TimeRange range;  // of the windows' ends
};

/// How far it is.
struct BackfillProgress {
  std::size_t windows = 0;   // in all
  std::size_t done = 0;      // of these
  std::size_t approved = 0;  // versions, those that were confirmed included
  std::string equipment;     // at work
  storage::Time window_end = 0;
};

/// Tries every window that holds new telemetry in its last slide and was never tried, and records
/// each. `database` is open for writing, and is the file of the configuration: threads open it
/// again for reading. `clock` gives the time of each record. After each window `report` is called;
/// false stops, and the next call goes on from there. Returns the progress at the end. Throws
/// storage::Error.
BackfillProgress backfill(storage::Database& database, const Config& config,
                          const BackfillRequest& request, WorkerPool& workers,
                          const std::function<storage::Time()>& clock,
                          const std::function<bool(const BackfillProgress&)>& report);

}  // namespace reident
