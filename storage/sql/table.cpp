#include "storage/sql/table.hpp"

namespace reident::storage::sql {

int connect_table(sqlite3* connection, const char* declaration, sqlite3_vtab** table,
                  char** message) {
  return guarded(message, [&] {
    const int code = sqlite3_declare_vtab(connection, declaration);
    if (code != SQLITE_OK) throw QueryError(code, sqlite3_errmsg(connection));
    sqlite3_vtab_config(connection, SQLITE_VTAB_INNOCUOUS);
    *table = new Table(connection);
  });
}

void give(sqlite3_context* context, std::string_view text) {
  if (text.data() == nullptr) return sqlite3_result_null(context);
  sqlite3_result_text(context, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
}

void give_copy(sqlite3_context* context, std::string_view text) {
  sqlite3_result_text(context, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

OwnedValue duplicate(const sqlite3_value* value) {
  OwnedValue copy(sqlite3_value_dup(value));
  if (!copy) throw std::bad_alloc();
  return copy;
}

}  // namespace reident::storage::sql
