#include "service/daemon/league_watch.hpp"

#include <algorithm>
#include <utility>

#include "service/support/log.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/window_cache.hpp"

namespace reident {

LeagueWatch::LeagueWatch(const Config& config) : settle_(config.settle) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      watched_.push_back(std::unique_ptr<Watched>(
          new Watched{&spacecraft.name, &equipment, {}, {spacecraft.name, equipment}}));
}

storage::TimeRange window_behind(const Change& change, const EquipmentConfig& equipment) {
  const Duration period = equipment.sample_period;
  const std::int64_t ticks = std::max(equipment.window / 2 / period, least_window_ticks(equipment));
  const storage::Time end =
      std::max(change.found, change.since + std::min(equipment.window, ticks * period));
  return {std::max(change.since, end - equipment.window), end};
}

std::vector<LeagueWatch::Drift> LeagueWatch::advance(std::size_t equipment,
                                                     const storage::Archive& archive,
                                                     const storage::Registry& registry,
                                                     storage::Time reached,
                                                     const LeagueContext& context) {
  Watched& watched = *watched_[equipment];
  const std::lock_guard lock(watched.mutex);
  const std::string& spacecraft = *watched.spacecraft;
  const std::string& name = watched.equipment->name;
  LeagueWriter writer;
  writer.scores = [&](const auto& block, const auto& scores) {
    context.write([&](storage::Registry& stored, auto&) {
      stored.record_scores(spacecraft, name, block, scores);
    });
  };
  writer.decide = [&](const storage::DecisionState& standing, const LeagueDecision& found) {
    bool recorded = false;
    context.write([&](storage::Registry& stored, auto&) {
      recorded = stored
                     .decide_if(standing, spacecraft, name, found.version.number, found.decision,
                                context.clock())
                     .has_value();
    });
    if (recorded && context.decided) context.decided(found);
    return recorded;
  };
  writer.failed = [&](const Reason& reason) {
    log::error("league", "the champion fails",
               {{"equipment", spacecraft + "/" + name}, {"reason", sentence(reason)}});
  };
  const auto change = watched.keeper.advance(archive, registry, reached, writer);
  if (!change) return {};
  return {{watched.spacecraft, watched.equipment, *change}};
}

void LeagueWatch::forget(std::size_t equipment, storage::TimeRange range) {
  const std::lock_guard lock(watched_[equipment]->mutex);
  watched_[equipment]->keeper.forget(range);
}

std::vector<LeagueWatch::Drift> LeagueWatch::look(const storage::Archive& archive,
                                                  const storage::Registry& registry,
                                                  WindowFeed& feed, const LeagueContext& context) {
  std::vector<Drift> drifts;
  for (std::size_t i = 0; i < watched_.size() && !context.stop(); ++i) {
    const storage::Time reached = feed.reached(i);
    if (reached == INT64_MIN) continue;  // none of its telemetry has come
    try {
      for (const Drift& drift : advance(i, archive, registry, reached - settle_, context))
        drifts.push_back(drift);
    } catch (const storage::Error& error) {
      if (error.what() != std::exchange(last_error_, error.what()))
        log::error("league", "versions cannot be scored; it is tried again",
                   {{"equipment", *watched_[i]->spacecraft + "/" + watched_[i]->equipment->name},
                    {"error", error.what()}});
    }
  }
  for (const Drift& drift : drifts) {
    const storage::TimeRange window = window_behind(drift.found, *drift.equipment);
    feed.ask(*drift.spacecraft, drift.equipment->name, "drift", window);
    log::warning("league", "the equipment has changed; it is identified again",
                 {{"equipment", *drift.spacecraft + "/" + drift.equipment->name},
                  {"window_begin", time_text(window.begin)},
                  {"window_end", time_text(window.end)}});
  }
  return drifts;
}

}  // namespace reident
