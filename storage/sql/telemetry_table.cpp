#include "storage/sql/telemetry_table.hpp"

#include <optional>

#include "storage/sql/archive_file.hpp"
#include "storage/sql/ordered_rows.hpp"
#include "storage/sql/plan.hpp"
#include "storage/sql/table.hpp"
#include "storage/types/utc_text.hpp"

namespace reident::storage::sql {
namespace telemetry_table {
namespace {

// What is used for each row comes first and is plain.
struct Cursor : sqlite3_vtab_cursor {
  explicit Cursor(Table& its_table) : sqlite3_vtab_cursor{}, table(its_table) {}

  std::size_t row = 0;
  std::size_t end = 0;         // row == end only behind the last one
  const Time* time = nullptr;  // of the range's columns
  const double* value = nullptr;
  const Quality* quality = nullptr;
  const std::int64_t* source = nullptr;
  const SeriesName* series = nullptr;

  std::int64_t named_source = 0;  // whose name is at hand
  std::string_view source_name;

  Table& table;
  std::optional<ArchiveFile> file;
  std::optional<OrderedRows> rows;

  void next_range() {
    row = end = 0;
    const auto range = rows->next();
    if (!range) return;
    row = range->begin;
    end = range->end;
    time = range->columns->time.data();
    value = range->columns->value.data();
    quality = range->columns->quality.data();
    source = range->columns->source.data();
    series = range->series;
  }
};

Cursor& cursor_of(sqlite3_vtab_cursor* cursor) {
  return *static_cast<Cursor*>(cursor);
}

int connect(sqlite3* connection, void*, int, const char* const*, sqlite3_vtab** table,
            char** message) {
  return connect_table(connection, telemetry_declaration, table, message);
}

int best_index(sqlite3_vtab* table, sqlite3_index_info* question) {
  int code = SQLITE_OK;
  const int failed = guarded(&table->zErrMsg, [&] { code = plan_telemetry(*question); });
  return failed != SQLITE_OK ? failed : code;
}

int filter(sqlite3_vtab_cursor* base, int columns, const char* text, int operands,
           sqlite3_value** values) {
  Cursor& cursor = cursor_of(base);
  return guarded(&base->pVtab->zErrMsg, [&] {
    cursor.rows.reset();
    cursor.row = cursor.end = 0;
    if (!cursor.file) cursor.file.emplace(cursor.table.connection, cursor.table.names);
    cursor.rows.emplace(*cursor.file,
                        understand(columns, text, {values, static_cast<std::size_t>(operands)}));
    cursor.next_range();
  });
}

int next(sqlite3_vtab_cursor* base) {
  Cursor& cursor = cursor_of(base);
  if (++cursor.row != cursor.end) return SQLITE_OK;
  return guarded(&base->pVtab->zErrMsg, [&] { cursor.next_range(); });
}

int at_end(sqlite3_vtab_cursor* base) {
  const Cursor& cursor = cursor_of(base);
  return cursor.row == cursor.end;
}

void give_source(sqlite3_context* context, Cursor& cursor) {
  const std::int64_t id = cursor.source[cursor.row];
  if (id != cursor.named_source || cursor.source_name.data() == nullptr) {
    cursor.named_source = id;
    cursor.source_name = cursor.file->source_name(id);
  }
  give(context, cursor.source_name);
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  Cursor& cursor = cursor_of(base);
  switch (static_cast<Column>(index)) {
    case Column::value:  // NaN becomes NULL
      sqlite3_result_double(context, cursor.value[cursor.row]);
      return SQLITE_OK;
    case Column::time:
      sqlite3_result_int64(context, cursor.time[cursor.row]);
      return SQLITE_OK;
    case Column::quality:
      give(context, name(cursor.quality[cursor.row]));
      return SQLITE_OK;
    case Column::spacecraft:
      give(context, cursor.series->spacecraft);
      return SQLITE_OK;
    case Column::parameter:
      give(context, cursor.series->parameter);
      return SQLITE_OK;
    case Column::origin:
      give(context, name(cursor.series->origin));
      return SQLITE_OK;
    case Column::series:
      sqlite3_result_int64(context, cursor.series->id);
      return SQLITE_OK;
    case Column::utc:
      return guarded(&base->pVtab->zErrMsg,
                     [&] { give_copy(context, utc_text(cursor.time[cursor.row])); });
    case Column::source:
      break;
  }
  return guarded(&base->pVtab->zErrMsg, [&] { give_source(context, cursor); });
}

}  // namespace
}  // namespace telemetry_table

int add_telemetry_table(sqlite3* connection) {
  using namespace telemetry_table;
  static const sqlite3_module module =
      table_module<Cursor>({connect, best_index, filter, next, at_end, column});
  return sqlite3_create_module(connection, "telemetry", &module, nullptr);
}

}  // namespace reident::storage::sql
