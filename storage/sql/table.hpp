// What the extension's tables have in common.
#pragma once

#include <memory>
#include <string_view>

#include "storage/sql/archive_file.hpp"
#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// One for each connection and kind of table.
struct Table : sqlite3_vtab {
  explicit Table(sqlite3* its_connection) : sqlite3_vtab{}, connection(its_connection) {}
  sqlite3* connection;
  NamePool names;  // outlives every cursor, as the values that statements keep do
};

/// A table that is there without a CREATE, and read alone.
int connect_table(sqlite3* connection, const char* declaration, sqlite3_vtab** table,
                  char** message);

/// The part of a module in which the tables differ.
struct TableCalls {
  decltype(sqlite3_module::xConnect) connect;
  decltype(sqlite3_module::xBestIndex) best_index;
  decltype(sqlite3_module::xFilter) filter;
  decltype(sqlite3_module::xNext) next;
  decltype(sqlite3_module::xEof) at_end;
  decltype(sqlite3_module::xColumn) column;
};

/// Cursor is made of a Table& and derived from sqlite3_vtab_cursor.
template <typename Cursor>
sqlite3_module table_module(const TableCalls& calls) {
  sqlite3_module module{};
  module.xConnect = calls.connect;
  module.xBestIndex = calls.best_index;
  module.xDisconnect = [](sqlite3_vtab* table) {
    delete static_cast<Table*>(table);
    return SQLITE_OK;
  };
  module.xOpen = [](sqlite3_vtab* table, sqlite3_vtab_cursor** cursor) {
    return guarded(&table->zErrMsg, [&] { *cursor = new Cursor(*static_cast<Table*>(table)); });
  };
  module.xClose = [](sqlite3_vtab_cursor* cursor) {
    delete static_cast<Cursor*>(cursor);
    return SQLITE_OK;
  };
  module.xFilter = calls.filter;
  module.xNext = calls.next;
  module.xEof = calls.at_end;
  module.xColumn = calls.column;
  return module;
}

/// A text in a NamePool or in the program; NULL where there is none.
void give(sqlite3_context* context, std::string_view text);
void give_copy(sqlite3_context* context, std::string_view text);

struct FreeValue {
  void operator()(sqlite3_value* value) const { sqlite3_value_free(value); }
};
using OwnedValue = std::unique_ptr<sqlite3_value, FreeValue>;
OwnedValue duplicate(const sqlite3_value* value);

}  // namespace reident::storage::sql
