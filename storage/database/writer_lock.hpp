// The right to be the one writer of a database file. Private to storage.
#pragma once

#include <filesystem>

namespace reident::storage {

/// Holds an advisory lock (flock) on "<database>.lock" until it is destroyed or its process ends
/// in whatever way. The file stays: taking it away could give two writers a lock each.
class WriterLock {
 public:
  /// Throws Error: locked, with the process that holds it, or cannot_open or read_only.
  explicit WriterLock(const std::filesystem::path& database);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

  /// Whether somebody holds the lock of this database now; false where that cannot be known.
  static bool is_held(const std::filesystem::path& database);

  /// Whether a writer before this one had tables in the file.
  bool had_tables() const { return had_tables_; }
  /// To be called when the file has its tables.
  void note_tables();

 private:
  bool had_tables_ = false;
  int descriptor_ = -1;
};

}  // namespace reident::storage
