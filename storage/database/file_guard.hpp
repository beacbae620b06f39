// What others may have done to the files of a database that is open. Private to storage.
//
// SQLite goes on with the files that it has open when somebody deletes, moves, replaces or cuts
// them; what it stores then is lost when it closes. A guard is asked before each transaction.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <sys/types.h>

#include "storage/database/database.hpp"

namespace reident::storage {

namespace sqlite {
class Connection;
}

/// Whether there is such a file and it is not empty.
bool has_content(const std::filesystem::path& file);

/// Throws Error corrupt for a file that has lost its end, and, where commits are flushed, for a log
/// that is damaged. To be called before the connection has read: what SQLite does not find it takes
/// for zeros, and the end of a damaged log it leaves out. Where `owns_log` is false another process
/// may be writing the log, and nothing is said of a file that has one.
void refuse_damaged_files(const sqlite::Connection& connection,
                          const std::filesystem::path& database, bool owns_log,
                          Durability durability);

class FileGuard {
 public:
  /// `database` is open in WAL mode for its one writer, so that all of its files exist.
  explicit FileGuard(const std::filesystem::path& database);

  /// Throws Error displaced where one of the files is not the one that was opened, and corrupt
  /// where the file has lost an end that SQLite will not copy from the log any more. The log is
  /// then kept when the connection closes.
  void check(sqlite::Connection& connection);

 private:
  struct File {
    std::string path;
    dev_t device = 0;
    ino_t inode = 0;
  };
  std::array<File, 4> files_;  // the writer's lock too: without it there may be a second writer
  /// A file that is shorter than it says while the log has the rest.
  struct Short {
    std::uint64_t pages = 0;
    std::uint32_t copied = 0;  // frames of the log
    bool operator==(const Short&) const = default;
  };
  std::optional<Short> held_;
};

}  // namespace reident::storage
