// One SQLite file that holds the archive and the registry.
//
// A file has at most one writer: a read_write Database holds an advisory lock on "<path>.lock"
// for its lifetime (the kernel drops it if the process dies). Readers need no lock. SQLite runs in
// WAL mode; SCHEMA.md states what survives which failure.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>

namespace reident::storage {

/// What, where and what would mend it. Thrown for a file that cannot be used, a full disk and the
/// like; nothing that was committed is lost.
class Error : public std::runtime_error {
 public:
  enum class Kind { cannot_open, locked, newer_schema, corrupt, full, read_only, failed };
  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

class Database {
 public:
  enum class Mode { read_only, read_write };

  /// read_write creates the file and its tables where they do not exist.
  Database(const std::filesystem::path& path, Mode mode);
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
