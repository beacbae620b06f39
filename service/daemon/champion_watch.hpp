// The monitors of all configured champions: each looks at new telemetry, and the window of a
// champion that drifts is asked for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/daemon/window_feed.hpp"
#include "service/judgement/champion_monitor.hpp"

namespace reident {

class ChampionWatch {
 public:
  struct Drift {
    const std::string* spacecraft = nullptr;
    const EquipmentConfig* equipment = nullptr;
    ChampionMonitor::Drift found;
  };

  /// The configuration must outlive the watch.
  explicit ChampionWatch(const Config& config);

  /// Looks at every champion up to where the feed's telemetry has settled, until `stop` answers
  /// true. What was found was asked for and logged. An archive that cannot be read is logged, and
  /// looked at again the next time.
  std::vector<Drift> look(const storage::Archive& archive, const storage::Registry& registry,
                          WindowFeed& feed, const std::function<bool()>& stop);

 private:
  struct Watched {
    const std::string* spacecraft;
    const EquipmentConfig* equipment;
    ChampionMonitor monitor;
  };
  std::optional<ChampionMonitor::Drift> look(Watched& watched, const storage::Archive& archive,
                                             const storage::Registry& registry,
                                             storage::Time reached);

  const Duration settle_;
  std::vector<Watched> watched_;  // in the configuration's order
  std::string last_error_;        // said once, not at each look
};

}  // namespace reident
