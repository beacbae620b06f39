// The leagues of all configured equipment, for all threads of the service.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "service/daemon/repeated_error.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/operations/league_keeper.hpp"

namespace reident {

/// How the daemon's threads write, and what they ask.
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
  /// Configuration and feed must outlive the watch.
  LeagueWatch(const Config& config, WindowFeed& feed);

  /// Advances the league of an equipment, by its place in the configuration, to `reached`; asks the
  /// feed for a window where a change is found. False where it is not advanced to `reached` because
  /// such a window, which ends before, has to be tried first; it asks for the window `then`, if
  /// any, too. `archive` and `registry` are of the calling thread. Throws storage::Error.
  bool advance(std::size_t equipment, const storage::Archive& archive,
               const storage::Registry& registry, storage::Time reached,
               const LeagueContext& context, const WindowFeed::Job* then = nullptr);

  /// Advances every league to where the feed's telemetry has settled and its windows were tried. An
  /// archive that cannot be read is logged, and read again the next time.
  void look(const storage::Archive& archive, const storage::Registry& registry,
            const LeagueContext& context);

  /// Names of the equipment whose champions fail, separated by commas. For any thread.
  std::string failing() const;

  /// Forgets all that was read of the registry: another service has recorded in it. For any thread.
  void read_again();

  /// Forgets what samples in `range` served.
  void forget(std::size_t equipment, storage::TimeRange range);

 private:
  struct Watched {
    const std::string* spacecraft;
    const EquipmentConfig* equipment;
    std::mutex mutex;
    EquipmentConfig on_its_ticks;           // what the keeper goes by
    std::optional<LeagueKeeper> keeper;     // from the first version on
    std::atomic<bool> is_outdated = false;  // the keeper
    std::atomic<bool> is_failing = false;
    RepeatedError failure{};  // of look()
  };
  const Duration settle_;
  WindowFeed& feed_;
  std::vector<std::unique_ptr<Watched>> watched_;  // in the configuration's order
};

}  // namespace reident
