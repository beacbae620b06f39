#include "service/daemon/window_attempt.hpp"

#include <algorithm>
#include <utility>

#include "service/windows/ticks.hpp"

namespace reident {
namespace {

/// The version's number, 0 without one; absent where the decision state has changed.
std::optional<std::int64_t> record(const storage::DecisionState& state, RefreshResult& result,
                                   const AttemptContext& context) {
  std::optional<std::int64_t> number;
  context.write([&](storage::Registry& registry, auto&) {
    result.attempt.time = context.clock();
    if (!result.candidate) {
      if (registry.decision_state(result.attempt.spacecraft, result.attempt.equipment) != state)
        return;
      registry.record(result.attempt);
      number = 0;
      return;
    }
    number = registry.record_if(state, result.attempt, result.version, *result.decision);
  });
  return number;
}

}  // namespace

std::optional<RecordedAttempt> attempt_window(const WindowFeed::Job& job,
                                              const storage::Archive& archive,
                                              const storage::Registry& registry, WindowCache& kept,
                                              const AttemptContext& context) {
  for (const storage::TimeRange& changed : job.changed) {
    kept.forget(changed);
    context.leagues->forget(job.window.equipment, changed);
  }
  const storage::Time end = job.window.window.end;
  // From here on the archive marks what still falls into the window.
  context.write([&](auto&, storage::Archive& stored) { stored.seal(*job.spacecraft, end); });
  if (!context.leagues->advance(job.window.equipment, archive, registry, end, context, &job))
    return std::nullopt;
  // Read before the champion and the hold are looked at.
  const storage::DecisionState state =
      registry.decision_state(*job.spacecraft, job.equipment->name);
  const RefreshRequest request{
      *job.spacecraft, with_phase(*job.equipment, *job.spacecraft, archive, registry),
      behind_champion(registry, *job.spacecraft, job.equipment->name, job.window.window),
      job.window.cause, context.configuration_digest};
  if (kept.request() != request_of(request.spacecraft, request.equipment))
    kept = window_cache_of(request.spacecraft, request.equipment);
  RecordedAttempt attempt{
      refresh(archive, registry, request, kept, context.for_each, context.stop)};
  const auto number = record(state, attempt.result, context);
  if (!number) return std::nullopt;
  attempt.version = *number;
  context.leagues->advance(job.window.equipment, archive, registry, end, context);
  return attempt;
}

}  // namespace reident
