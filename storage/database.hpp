// One SQLite file that holds the archive and the registry.
//
// A file has at most one writer: a read_write Database holds an advisory lock on "<path>.lock"
// for its lifetime (the kernel drops it if the process dies). Readers need no lock. SQLite runs in
// WAL mode; SCHEMA.md states what survives which failure.
//
// A Database, with every Archive and Registry made on it, belongs to one thread at a time. Threads
// that work at the same time each open their own.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>

namespace reident::storage {

/// What, where and what would mend it. Thrown for a file that cannot be used, a full disk and the
/// like; nothing that was committed is lost.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    cannot_open,   // no such file, a folder, not ours, no permission
    locked,        // another process writes
    newer_schema,  // made by a newer program
    older_schema,  // made by an older program and opened to be read alone
    corrupt,       // damaged or cut short
    full,          // no room on the disk, in the quota or in the file size limit
    read_only,     // the file, its folder or the connection cannot be written
    displaced,     // deleted, moved or replaced while it was open
    failed         // anything else; the message has SQLite's own words
  };
  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// What a commit survives once it returned; SCHEMA.md, "What survives which failure", says what a
/// power cut takes at most otherwise.
enum class Durability {
  power_cut,  // the log is on the disk before a commit returns
  kill        // the log is in the hands of the system; it is put on the disk now and then
};

class Database {
 public:
  enum class Mode { read_only, read_write };

  /// read_write creates the file and its tables where they do not exist, and brings the tables of
  /// an older schema up to date, in one transaction. `durability` matters to read_write alone.
  Database(const std::filesystem::path& path, Mode mode,
           Durability durability = Durability::power_cut);
  ~Database();
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;

  const std::filesystem::path& path() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace reident::storage
