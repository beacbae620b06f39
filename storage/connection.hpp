// What a Database holds. Private to storage.
#pragma once

#include <filesystem>
#include <optional>

#include "storage/sqlite.hpp"
#include "storage/writer_lock.hpp"

namespace reident::storage {

// The connection closes, and folds the log into the file, before the lock is given up.
struct Database::Impl {
  std::filesystem::path path;
  std::optional<WriterLock> lock;
  std::optional<sqlite::Connection> connection;
};

}  // namespace reident::storage
