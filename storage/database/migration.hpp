// Files of older schema versions. Private to storage.
#pragma once

#include <cstdint>

#include "storage/database/sqlite.hpp"

namespace reident::storage {

/// The step from schema 2 to 3 that needs the chunks' codec: moves the rows of the table `sample`
/// into chunks. Declared for the opener, and defined by the archive (samples_to_chunks.cpp), which
/// the opener does not see.
void samples_to_chunks(sqlite::Connection& connection);

/// Brings a file from `version`, at least 1, to this program's. Within a transaction of the caller.
void migrate(sqlite::Connection& connection, std::int64_t version);

}  // namespace reident::storage
