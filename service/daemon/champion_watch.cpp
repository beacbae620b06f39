#include "service/daemon/champion_watch.hpp"

#include <utility>

#include "service/support/log.hpp"
#include "service/support/time_text.hpp"

namespace reident {

ChampionWatch::ChampionWatch(const Config& config) : settle_(config.settle) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      watched_.push_back({&spacecraft.name, &equipment, {spacecraft.name, equipment}});
}

std::optional<ChampionMonitor::Drift> ChampionWatch::look(Watched& watched,
                                                          const storage::Archive& archive,
                                                          const storage::Registry& registry,
                                                          storage::Time reached) {
  try {
    return watched.monitor.look(archive, registry, reached - settle_, watched.equipment->window);
  } catch (const storage::Error& error) {
    if (error.what() != std::exchange(last_error_, error.what()))
      log::error("monitor", "the champion cannot be looked at; it is tried again",
                 {{"equipment", *watched.spacecraft + "/" + watched.equipment->name},
                  {"error", error.what()}});
    return std::nullopt;
  }
}

std::vector<ChampionWatch::Drift> ChampionWatch::look(const storage::Archive& archive,
                                                      const storage::Registry& registry,
                                                      WindowFeed& feed,
                                                      const std::function<bool()>& stop) {
  std::vector<Drift> drifts;
  for (std::size_t i = 0; i < watched_.size() && !stop(); ++i) {
    const storage::Time reached = feed.reached(i);
    if (reached == INT64_MIN) continue;  // none of its telemetry has come
    Watched& watched = watched_[i];
    const auto drift = look(watched, archive, registry, reached);
    if (!drift) continue;
    const storage::TimeRange window = ChampionMonitor::window_of(*drift, *watched.equipment);
    feed.ask(*watched.spacecraft, watched.equipment->name, "drift", window);
    log::warning("monitor", "the champion drifts; its equipment is identified anew",
                 {{"equipment", *watched.spacecraft + "/" + watched.equipment->name},
                  {"version", drift->version},
                  {"window_begin", time_text(window.begin)},
                  {"window_end", time_text(window.end)},
                  {"error_ratio", drift->error_ratio}});
    drifts.push_back({watched.spacecraft, watched.equipment, *drift});
  }
  return drifts;
}

}  // namespace reident
