// What speaks for a version and against it, in one sentence and by condition.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/review/conditions.hpp"
#include "service/review/stored_version.hpp"

namespace reident {

struct Verdict {
  std::string sentence;
  std::vector<Condition> conditions;  // empty where it was never compared with a champion
  std::optional<Finding> now;         // of a version that waits, from its record
};

/// Returns what the record of a version that waits says now; else its last decision, with the
/// conditions as they were found then. Of a champion it also says what waits to replace it, and
/// whether it has failed.
Verdict verdict_of(const history::HistoryReader& history, const StoredVersion& story);

}  // namespace reident
