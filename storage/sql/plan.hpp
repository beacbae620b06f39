// What SQLite and the virtual table agree on before a statement runs: which conditions and which
// order the table takes over. Passed from xBestIndex to xFilter as text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "storage/sql/selection.hpp"
#include "storage/sql/series_blocks.hpp"
#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// SampleColumns of the table telemetry. `series` is the id in the table series; with the time it
/// is what makes a row unique.
enum class Column : char {
  spacecraft,
  parameter,
  source,
  time,
  value,
  quality,
  origin,
  utc,
  series
};

inline constexpr const char* telemetry_declaration =
    "CREATE TABLE telemetry (spacecraft TEXT, parameter TEXT, source TEXT, time INTEGER, value, "
    "quality TEXT, origin TEXT HIDDEN, utc TEXT HIDDEN, series INTEGER HIDDEN, "
    "PRIMARY KEY (series, time)) WITHOUT ROWID";

struct OrderTerm {
  Column column = Column::time;
  bool descending = false;
};

/// Rows in the order of `before` (spacecraft, parameter, origin), within that by time if asked for,
/// within one time in the order of `after`.
struct RowOrder {
  std::vector<OrderTerm> before, after;
  bool by_time = false;
  bool descending = false;  // in time
};

/// How a table takes over a condition on a text column of a series; none where SQLite keeps it. A
/// list (IN) is taken over as a whole.
std::optional<Comparison> text_condition(sqlite3_index_info& question, int index);

/// Answers SQLite's question how a statement would be run.
int plan_telemetry(sqlite3_index_info& question);

struct Plan {
  Selection selection;
  RowOrder order;
  WantedColumns wanted;
};

/// The plan that plan_telemetry() passed on, with the values of the conditions.
Plan understand(int columns, const char* text, std::span<sqlite3_value*> operands);

}  // namespace reident::storage::sql
