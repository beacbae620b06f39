// What a Database holds. Private to storage.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "storage/database/sqlite.hpp"
#include "storage/database/writer_lock.hpp"

namespace reident::storage {

/// What a component keeps with a database while that is open.
struct Database::Attachment {
  virtual ~Attachment() = default;
};

// The connection closes, and folds the log into the file, before the lock is given up.
struct Database::Impl {
  std::filesystem::path path;
  std::optional<WriterLock> lock;
  std::optional<sqlite::Connection> connection;
  std::unique_ptr<Attachment> archive;  // archive_access.hpp
};

inline sqlite::Connection& connection(const Database& database) {
  return *database.impl().connection;
}

}  // namespace reident::storage
