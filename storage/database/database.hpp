// One SQLite file that holds the archive and the registry.
//
// A file has at most one writer: a read_write Database holds an advisory lock on "<path>.lock"
// for its lifetime (the kernel drops it if the process dies). Readers need no lock, and work while
// the writer writes. SQLite runs in WAL mode; SCHEMA.md states what survives which failure.
//
// A Database, with every Archive and Registry made on it, belongs to one thread at a time. Threads
// that work at the same time each open their own.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/types/error.hpp"

namespace reident::storage {

/// What a commit survives once it returned; SCHEMA.md, "What survives which failure", says what a
/// power cut takes at most otherwise.
enum class Durability {
  power_cut,  // the log is on the disk before a commit returns
  kill        // the log is in the hands of the system; it is put on the disk now and then
};

/// An open file. Archive and Registry work on one.
class Database {
 public:
  enum class Mode { read_only, read_write, update };

  /// Opens the file at `path`. read_write creates the file and its tables where they do not exist,
  /// and brings the tables of an older schema up to date, in one transaction; update is read_write
  /// for a file that exists. `durability` matters to these two alone. The folder exists. Throws
  /// Error, and leaves the file as it is: cannot_open, locked (another process writes it),
  /// newer_schema, older_schema (read_only alone), corrupt, full or read_only.
  Database(const std::filesystem::path& path, Mode mode,
           Durability durability = Durability::power_cut);
  ~Database();
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;

  /// Whether a process has the database at `path` open for writing now. False where that cannot be
  /// known, as where no database was ever there.
  static bool has_writer(const std::filesystem::path& path);

  /// The file's own path, links resolved.
  const std::filesystem::path& path() const;

  /// For storage itself.
  struct Attachment;
  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace reident::storage
