// The table-valued function telemetry_summary(begin_time, end_time, step, quality): one row for
// each series and step.
#pragma once

#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// Makes the table known on a connection; returns SQLite's code.
int add_summary_table(sqlite3* connection);

}  // namespace reident::storage::sql
