// Reads a write-ahead log as SQLite will, before SQLite does: what it would leave out of a damaged
// one it leaves out without a word. Private to storage.
//
// The format is SQLite's (https://www.sqlite.org/fileformat2.html, section 4). A log has commits
// that end in a commit frame. Frames are chained by checksums: SQLite takes the log up to the first
// one that does not fit, and of that the whole commits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace reident::storage {

struct LogContents {
  std::uint32_t page_size = 0;  // 0 where there is no log
  std::uint32_t pages = 0;      // of the database after the last whole commit; 0 without one
  /// By the number of a page, the last frame that has it in a whole commit; the first frame is 1.
  std::map<std::uint32_t, std::uint32_t> held;
  /// What was on the disk once and is damaged now, in words; absent where the log ends as a log
  /// that was cut off by a crash may end. A commit's frames are flushed before those of the next
  /// are written (Durability::power_cut), so whatever has a later commit behind it was whole.
  std::optional<std::string> damage;
};

/// An absent or empty log has no contents. The log must not be written meanwhile.
LogContents read_log(const std::filesystem::path& log);

}  // namespace reident::storage
