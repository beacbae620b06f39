#include "tests/storage/sql/sql_user.hpp"

#include <cstdio>
#include <stdexcept>

namespace reident::storage::test {
namespace {

std::string text_of(sqlite3_stmt* statement, int column) {
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_NULL:
      return "NULL";
    case SQLITE_FLOAT: {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", sqlite3_column_double(statement, column));
      return text;
    }
    default:
      return reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  }
}

}  // namespace

SqlUser::SqlUser(const std::filesystem::path& database) {
  sqlite3* handle = nullptr;
  const int opened = sqlite3_open(database.c_str(), &handle);
  handle_.reset(handle);
  if (opened != SQLITE_OK) throw std::runtime_error("cannot open " + database.string());
  sqlite3_busy_timeout(handle, 10'000);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 1, nullptr);
  char* message = nullptr;
  if (sqlite3_load_extension(handle, REIDENT_TELEMETRY_EXTENSION, nullptr, &message) != SQLITE_OK)
    throw std::runtime_error(message);
}

std::optional<std::string> SqlUser::each_row(const std::string& sql,
                                             const std::function<void(sqlite3_stmt*)>& use) const {
  sqlite3_stmt* prepared = nullptr;
  int code = sqlite3_prepare_v2(handle(), sql.c_str(), -1, &prepared, nullptr);
  const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(prepared,
                                                                             &sqlite3_finalize);
  while (code == SQLITE_OK || code == SQLITE_ROW) {
    code = sqlite3_step(prepared);
    if (code == SQLITE_ROW) use(prepared);
  }
  if (code == SQLITE_DONE) return std::nullopt;
  return "error " + std::to_string(sqlite3_extended_errcode(handle())) + ": " +
         sqlite3_errmsg(handle());
}

std::vector<std::string> SqlUser::ask(const std::string& sql) const {
  std::vector<std::string> rows;
  const auto error = each_row(sql, [&rows](sqlite3_stmt* statement) {
    std::string row;
    for (int i = 0; i < sqlite3_column_count(statement); ++i)
      row += (i > 0 ? "|" : "") + text_of(statement, i);
    rows.push_back(row);
  });
  if (error) rows.push_back(*error);
  return rows;
}

}  // namespace reident::storage::test
