#include "service/daemon/confirmation_watch.hpp"

#include <algorithm>
#include <utility>

#include "service/support/log.hpp"

namespace reident {
namespace {

/// The registry is asked once in so small a part of `confirmation`: telemetry comes far more often.
constexpr int asked_in_confirmation = 64;
constexpr Duration least_pause = 1'000'000'000;

}  // namespace

ConfirmationWatch::ConfirmationWatch(const Config& config) : settle_(config.settle) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      watched_.push_back({&spacecraft.name, &equipment});
}

void ConfirmationWatch::look(Watched& watched, storage::Time reached,
                             const storage::Archive& archive, const storage::Registry& registry,
                             const AttemptContext& context) {
  const EquipmentConfig& equipment = *watched.equipment;
  const Duration pause = std::max(equipment.confirmation / asked_in_confirmation, least_pause);
  if (reached < watched.since + pause) return;
  try {
    const storage::DecisionState state =
        registry.decision_state(*watched.spacecraft, equipment.name);
    if (state != watched.state) watched.since = INT64_MIN;
    decide_probation(archive, registry, *watched.spacecraft, equipment, watched.since, reached,
                     context);
    watched.since = reached;
    watched.state = state;
  } catch (const storage::Error& error) {
    if (error.what() != std::exchange(last_error_, error.what()))
      log::error(
          "monitor", "versions on probation cannot be looked at; it is tried again",
          {{"equipment", *watched.spacecraft + "/" + equipment.name}, {"error", error.what()}});
  }
}

void ConfirmationWatch::look(const storage::Archive& archive, const storage::Registry& registry,
                             const WindowFeed& feed, const AttemptContext& context) {
  for (std::size_t i = 0; i < watched_.size() && !context.stop(); ++i)
    if (const storage::Time reached = feed.reached(i); reached != INT64_MIN)
      look(watched_[i], reached - settle_, archive, registry, context);
}

}  // namespace reident
