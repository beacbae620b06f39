// Arguments of telemetry_summary(). Other than a condition, an argument that means nothing is an
// error: it would otherwise give a summary of something else. NULL is an argument left out.
#pragma once

#include <optional>

#include "storage/sql/selection.hpp"
#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// Narrows to times from (or below) nanoseconds, or a text such as '2026-03-01' or
/// '2026-03-01 12:30' (UTC).
void narrow_to_argument(TimeBounds& bounds, Comparison comparison, const char* name,
                        sqlite3_value* argument);
/// Nanoseconds above 0 from a number, or a text such as '10min', '1h', '1d'.
std::optional<std::int64_t> step_argument(sqlite3_value* argument);
/// One of the qualities' names.
void narrow_to_quality(TextChoice& quality, sqlite3_value* argument);

}  // namespace reident::storage::sql
