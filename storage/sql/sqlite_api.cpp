#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

Statement::Statement(sqlite3* connection, std::string_view text) : connection_(connection) {
  check(sqlite3_prepare_v3(connection, text.data(), static_cast<int>(text.size()),
                           SQLITE_PREPARE_PERSISTENT, &statement_, nullptr));
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  const int reset = sqlite3_reset(statement_);
  check(code == SQLITE_DONE ? SQLITE_OK : reset);
  return false;
}

std::string_view Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

std::span<const std::uint8_t> Statement::blob(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

void Statement::bind_one(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_, index, value));
}

void Statement::bind_one(int index, std::string_view text) {
  check(sqlite3_bind_text(statement_, index, text.data(), static_cast<int>(text.size()),
                          SQLITE_STATIC));
}

void Statement::check(int code) const {
  if (code == SQLITE_OK) return;
  if (code == SQLITE_NOMEM) throw std::bad_alloc();
  throw QueryError(code, sqlite3_errmsg(connection_));
}

}  // namespace reident::storage::sql
