// The virtual table telemetry: every sample of the archive as a row.
#pragma once

#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// Makes the table known on a connection; returns SQLite's code.
int add_telemetry_table(sqlite3* connection);

}  // namespace reident::storage::sql
