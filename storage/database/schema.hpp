// Tables and views of a database file; SCHEMA.md describes them. Private to storage.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace reident::storage::schema {

inline constexpr std::int64_t application_id = 0x72656964;  // "reid"
inline constexpr std::int64_t version = 10;                 // kept in SQLite's user_version

/// Whether `first` to `last` cannot be the batches of the table `recent`, for far more than any
/// configuration lets wait: a damaged number is one of them, and nobody counts up to it.
constexpr bool are_too_many_batches(std::int64_t first, std::int64_t last) {
  constexpr std::uint64_t most = 1 << 24;
  if (last < first) return false;
  return last == std::numeric_limits<std::int64_t>::max() ||
         static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first) > most;
}

/// A table whose rows the services of a pair share, and the columns that name a row in the journal.
struct JournalledTable {
  std::string_view name;
  std::array<std::string_view, 4> key;  // the rest is empty
};
/// Each row refers to rows of the tables before it alone.
inline constexpr std::array journalled_tables{
    JournalledTable{"term", {"number"}},
    JournalledTable{"attempt", {"id"}},
    JournalledTable{"version", {"attempt"}},
    JournalledTable{"decision", {"id"}},
    JournalledTable{"hold", {"id"}},
    JournalledTable{"command", {"id"}},
    JournalledTable{"alarm", {"id"}},
    JournalledTable{"change", {"id"}},
    JournalledTable{"simulator", {"id"}},
    JournalledTable{"block", {"spacecraft", "equipment", "begin_time"}},
    JournalledTable{"score", {"spacecraft", "equipment", "version", "begin_time"}}};

/// The key of a row as a JSON array in SQL, of columns that begin with `prefix`.
std::string key_sql(const JournalledTable& table, const std::string& prefix);

/// Statements that make everything in an empty file, application_id and user_version included.
std::string creation();

/// Statements that take a file from one version to the next. Version 3 has no table `sample`: it is
/// dropped once its rows are in chunks. Files of version 4 differ from those of 5 in what they may
/// hold: no quality `disputed`.
std::string from_1_to_2();
std::string from_2_to_3();
std::string without_samples_of_2();
std::string from_3_to_4();
std::string from_5_to_6();
std::string from_6_to_7();
std::string from_7_to_8();
std::string bias_effects_of_8();  // from_5_to_6() makes these too
std::string shards_of_9();
std::string chunks_of_9();  // from_2_to_3() makes these too
std::string series_view_of_10();

/// The statement that makes a trigger which aborts an event on a table.
std::string guard(const std::string& table, const std::string& event, const std::string& condition);

/// Statements that take away the triggers which keep rows of these tables from being removed, and
/// that make them again.
std::string without_removal_guards();
std::string removal_guards();

/// Says that the file is of this version.
std::string user_version();

}  // namespace reident::storage::schema
