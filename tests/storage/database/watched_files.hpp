// What SQLite asks of its files, seen and, where a test wants so, cut off by a kill.
//
// While a WatchedFiles exists every connection that is opened goes through it: a VFS in front of
// SQLite's own. Tests use it to kill a process at a chosen operation, and to record what would be
// on a disk when the power fails (unsafe_disk.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace reident::storage::test {

/// One request that changes a file, or the lock that a writer takes in the log.
struct FileOperation {
  enum class Kind { create, write, truncate, sync, remove, begin, end };
  Kind kind = Kind::write;
  std::string path;
  std::int64_t offset = 0;     // of a write; of a truncate the new length
  std::string bytes;           // of a write
  bool folder_synced = false;  // of a remove: it is on the disk when the call returns
};

class WatchedFiles {
 public:
  enum class Fate { happens, killed_before, killed_half_way };
  /// Asked before each operation. A kill is a SIGKILL of the own process; half way, a write has
  /// put the first half of its bytes into the file.
  using Observer = std::function<Fate(const FileOperation&)>;

  /// One at a time in a process.
  explicit WatchedFiles(Observer observer);
  ~WatchedFiles();
  WatchedFiles(const WatchedFiles&) = delete;
  WatchedFiles& operator=(const WatchedFiles&) = delete;
};

}  // namespace reident::storage::test
