// One window from its seal to its attempt in the registry, wherever the database's writer is.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "service/daemon/league_watch.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/operations/refresh.hpp"

namespace reident {

/// What an attempt at a window needs of the program around it.
struct AttemptContext : LeagueContext {
  std::string configuration_digest;
  identification::ForEach for_each;  // the search runs on it; absent: on the calling thread
  LeagueWatch* leagues = nullptr;
};

struct RecordedAttempt {
  RefreshResult result;
  std::int64_t version = 0;  // 0 where the window gave no model
};

/// Seals the window, advances the equipment's league to its end, tries what of it does not lie
/// before the champion's window, commits what came out, and advances the league again: a first
/// version may be good enough already. Absent, and nothing recorded of the window, where the
/// equipment's decision state is not the one that the attempt saw any more. `archive` and
/// `registry` are of the calling thread; `kept` is of the job's equipment. Throws Stopped where
/// `stop` answered true.
std::optional<RecordedAttempt> attempt_window(const WindowFeed::Job& job,
                                              const storage::Archive& archive,
                                              const storage::Registry& registry, WindowCache& kept,
                                              const AttemptContext& context);

}  // namespace reident
