// As much of SQLite as the plain table and the questions in SQL need.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <sqlite3.h>

namespace reident::bench {

struct CloseDatabase {
  void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
};
using SqliteHandle = std::unique_ptr<sqlite3, CloseDatabase>;

struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using SqliteStatement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

inline void check(sqlite3* handle, int code) {
  if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE)
    throw std::runtime_error(sqlite3_errmsg(handle));
}

inline SqliteHandle open_sqlite(const std::filesystem::path& file, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
  SqliteHandle owned(handle);
  check(handle, code);
  return owned;
}

inline void execute(const SqliteHandle& handle, const std::string& sql) {
  check(handle.get(), sqlite3_exec(handle.get(), sql.c_str(), nullptr, nullptr, nullptr));
}

inline SqliteStatement prepare(const SqliteHandle& handle, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  check(handle.get(), sqlite3_prepare_v3(handle.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                         &statement, nullptr));
  return SqliteStatement(statement);
}

}  // namespace reident::bench
