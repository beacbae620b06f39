// The leagues of all configured equipment, for all threads of the service.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "service/daemon/window_feed.hpp"
#include "service/operations/league_keeper.hpp"

namespace reident {

/// How the daemon's threads write and what they are told.
struct LeagueContext {
  using Task = std::function<void(storage::Registry&, storage::Archive&)>;
  /// Runs a task on the thread that writes the database, and returns when it is done.
  std::function<void(const Task&)> write;
  Clock clock;
  std::function<bool()> stop;
  /// Called with each decision that was recorded; may be empty.
  std::function<void(const LeagueDecision&)> decided{};
};

class LeagueWatch {
 public:
  struct Drift {
    const std::string* spacecraft = nullptr;
    const EquipmentConfig* equipment = nullptr;
    Change found;
  };

  /// The configuration must outlive the watch.
  explicit LeagueWatch(const Config& config);

  /// Advances the league of an equipment, by its place in the configuration, to `reached`; asks the
  /// feed for a window where a change was found. `archive` and `registry` are of the calling
  /// thread. Throws storage::Error.
  std::vector<Drift> advance(std::size_t equipment, const storage::Archive& archive,
                             const storage::Registry& registry, storage::Time reached,
                             const LeagueContext& context);

  /// Advances every league to where the feed's telemetry has settled, but for those of which a
  /// window is due or in work. An archive that cannot be read is logged, and read again the next
  /// time.
  std::vector<Drift> look(const storage::Archive& archive, const storage::Registry& registry,
                          WindowFeed& feed, const LeagueContext& context);

  /// Forgets what samples in `range` served.
  void forget(std::size_t equipment, storage::TimeRange range);

 private:
  struct Watched {
    const std::string* spacecraft;
    const EquipmentConfig* equipment;
    std::mutex mutex;
    LeagueKeeper keeper;
  };
  const Duration settle_;
  std::vector<std::unique_ptr<Watched>> watched_;  // in the configuration's order
  std::string last_error_;                         // said once, not at each look
};

/// The window to identify from behind a change: it begins with it, and ends where that was found,
/// or later, where half of the configured window, or what a window needs at least, lies behind its
/// begin.
storage::TimeRange window_behind(const Change& change, const EquipmentConfig& equipment);

}  // namespace reident
