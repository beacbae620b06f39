#include "service/daemon/league_watch.hpp"

#include <algorithm>
#include <utility>

#include "service/support/log.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/ticks.hpp"

namespace reident {

LeagueWatch::LeagueWatch(const Config& config, WindowFeed& feed)
    : settle_(config.settle), feed_(feed) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      watched_.push_back(
          std::unique_ptr<Watched>(new Watched{&spacecraft.name, &equipment, {}, {}, {}}));
}

bool LeagueWatch::advance(std::size_t equipment, const storage::Archive& archive,
                          const storage::Registry& registry, storage::Time reached,
                          const LeagueContext& context, const WindowFeed::Job* then) {
  Watched& watched = *watched_[equipment];
  const std::lock_guard lock(watched.mutex);
  const std::string& spacecraft = *watched.spacecraft;
  const std::string& name = watched.equipment->name;
  if (watched.is_outdated.exchange(false)) watched.keeper.reset();
  if (!watched.keeper) {
    watched.is_failing = false;
    // The first version decides where ticks stand.
    if (registry.decision_state(spacecraft, name).last_decision == 0) return true;
    watched.on_its_ticks = with_phase(*watched.equipment, spacecraft, archive, registry);
    watched.keeper.emplace(spacecraft, watched.on_its_ticks);
  }
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
  writer.failure = [&](const std::optional<Reason>& reason) {
    if (reason)
      log::error("league", "the champion fails",
                 {{"equipment", spacecraft + "/" + name}, {"reason", sentence(*reason)}});
    else if (watched.is_failing)
      log::info("league", "no champion fails any more", {{"equipment", spacecraft + "/" + name}});
    watched.is_failing = reason.has_value();
    context.write([&](storage::Registry& stored, auto&) {
      note_failure(stored, {spacecraft, name}, reason, context.clock());
    });
  };
  writer.change = [&](const storage::FoundChange& change) {
    context.write([&](storage::Registry& stored, auto&) {
      stored.record_change({spacecraft, name}, change, context.clock());
    });
  };
  while (const auto window = watched.keeper->advance(archive, registry, reached, writer)) {
    log::warning("league", "the equipment has changed; it is identified again",
                 {{"equipment", spacecraft + "/" + name},
                  {"window_begin", time_text(window->begin)},
                  {"window_end", time_text(window->end)}});
    feed_.ask(spacecraft, name, "drift", *window);
    if (window->end >= reached) continue;
    // At once, before those behind it: versions meet each other in the order of time.
    if (then) feed_.ask(spacecraft, name, then->window.cause, then->window.window);
    return false;
  }
  return true;
}

std::string LeagueWatch::failing() const {
  std::string names;
  for (const auto& watched : watched_)
    if (watched->is_failing)
      names += (names.empty() ? "" : ", ") + *watched->spacecraft + "/" + watched->equipment->name;
  return names;
}

void LeagueWatch::read_again() {
  for (const auto& watched : watched_) watched->is_outdated = true;
}

void LeagueWatch::forget(std::size_t equipment, storage::TimeRange range) {
  const std::lock_guard lock(watched_[equipment]->mutex);
  if (auto& keeper = watched_[equipment]->keeper) keeper->forget(range);
}

void LeagueWatch::look(const storage::Archive& archive, const storage::Registry& registry,
                       const LeagueContext& context) {
  for (std::size_t i = 0; i < watched_.size() && !context.stop(); ++i) {
    const storage::Time reached = feed_.tried_until(i);
    if (reached == INT64_MIN) continue;  // none of its telemetry has come
    try {
      advance(i, archive, registry, reached - settle_, context);
      watched_[i]->failure.succeeded();
    } catch (const storage::Error& error) {
      if (watched_[i]->failure.is_news(error.what()))
        log::error("league", "versions cannot be scored; it is tried again",
                   {{"equipment", *watched_[i]->spacecraft + "/" + watched_[i]->equipment->name},
                    {"error", error.what()}});
    }
  }
}

}  // namespace reident
