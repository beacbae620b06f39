// Files of older schema versions. Private to storage.
#pragma once

#include <cstdint>

#include "storage/sqlite.hpp"

namespace reident::storage {

/// Brings a file from `version`, at least 1, to this program's. Within a transaction of the caller.
void migrate(sqlite::Connection& connection, std::int64_t version);

}  // namespace reident::storage
