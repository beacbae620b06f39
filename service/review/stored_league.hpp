// The record of a version beside the champion that it is, or was, judged against.
#pragma once

#include <optional>

#include "service/judgement/league.hpp"
#include "service/review/stored_version.hpp"

namespace reident {

/// A version's record and what it is judged by.
struct StoredRecord {
  League league;  // its challengers have the version's record
  EquipmentConfig limits;
  std::optional<Change> change;

  /// The version's place in the league. Requires that it is there, which stored_record() does.
  const Member& member(std::int64_t version) const;
};

/// Reads the records. Absent where the version was never scored beside a champion: it is of a
/// program before version 0.2, was refused at its window, or was the first.
std::optional<StoredRecord> stored_record(const history::HistoryReader& history,
                                          const StoredVersion& story);

/// What the records say of a version that waits. Absent where it does not, or has none.
std::optional<Finding> finding_now(const StoredRecord& record, const StoredVersion& story);

/// Why the champion, which `attempt` made, fails now (Judge::failure()). Absent where it does not.
std::optional<Reason> failure_now(const history::HistoryReader& history,
                                  const storage::Attempt& attempt, std::int64_t champion);

}  // namespace reident
