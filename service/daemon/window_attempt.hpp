// One window from its seal to its attempt in the registry, and what becomes of versions on
// probation, wherever the database's writer is.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "service/daemon/window_feed.hpp"
#include "service/judgement/confirmation.hpp"
#include "service/operations/refresh.hpp"

namespace reident {

/// What an attempt at a window needs of the program around it.
struct AttemptContext {
  using Task = std::function<void(storage::Registry&, storage::Archive&)>;
  std::string configuration_digest;
  /// Runs a task on the thread that writes the database, and returns when it is done.
  std::function<void(const Task&)> write;
  Clock clock;
  identification::ForEach for_each;  // the search runs on it; absent: on the calling thread
  std::function<bool()> stop;
  /// Called with each version on probation that was decided; may be empty.
  std::function<void(const ProbationDecision&)> decided{};
};

struct RecordedAttempt {
  RefreshResult result;
  std::int64_t version = 0;  // 0 where the window gave no model
};

/// Looks at the equipment's versions on probation (probation.hpp) and commits what was decided.
void decide_probation(const storage::Archive& archive, const storage::Registry& registry,
                      const std::string& spacecraft, const EquipmentConfig& equipment,
                      storage::Time since, storage::Time reached, const AttemptContext& context);

/// Seals the window, looks at the equipment's versions on probation with the telemetry up to its
/// end, tries what of it does not lie before the champion's window and commits what came out;
/// nothing is published. Absent, and nothing recorded of the window, where the equipment's decision
/// state is not the one that the attempt saw any more. `archive` and `registry` are of the calling
/// thread; `kept` is of the job's equipment. Throws Stopped where `stop` answered true.
std::optional<RecordedAttempt> attempt_window(const WindowFeed::Job& job,
                                              const storage::Archive& archive,
                                              const storage::Registry& registry, WindowCache& kept,
                                              const AttemptContext& context);

}  // namespace reident
