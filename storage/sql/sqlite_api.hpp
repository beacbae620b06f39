// SQLite as its host gives it to an extension: through a table of functions, never linked. Also
// what every part of the extension needs of it: a statement with an owner, and errors as values for
// C.
#pragma once

#include <cstdint>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include <sqlite3ext.h>

extern "C" {
SQLITE_EXTENSION_INIT3
}

namespace reident::storage::sql {

/// Ends the user's statement; `code` is one of SQLite's, the message says what, where and the
/// remedy.
class QueryError : public std::runtime_error {
 public:
  QueryError(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

/// Runs a callback of SQLite, through which no exception may pass; its message goes to `*message`.
template <typename Work>
int guarded(char** message, const Work& work) noexcept {
  try {
    work();
    return SQLITE_OK;
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  } catch (const QueryError& error) {
    sqlite3_free(*message);
    *message = sqlite3_mprintf("%s", error.what());
    return error.code();
  } catch (const std::exception& error) {
    sqlite3_free(*message);
    *message = sqlite3_mprintf("%s", error.what());
    return SQLITE_ERROR;
  }
}

/// A statement of the extension's own on the user's connection. It reads within the transaction of
/// the user's statement. SampleColumns and blobs are valid until the next call.
class Statement {
 public:
  Statement(sqlite3* connection, std::string_view text);
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Starts again with these values for all parameters.
  template <typename... Values>
  Statement& bind(const Values&... values) {
    sqlite3_reset(statement_);
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }
  /// True while there is a row to read; the statement is reset after the last one.
  bool step();
  void reset() { sqlite3_reset(statement_); }

  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  double real(int column) const { return sqlite3_column_double(statement_, column); }
  std::string_view text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;

 private:
  void bind_one(int index, std::int64_t value);
  void bind_one(int index, std::string_view text);  // which must outlive the steps
  void check(int code) const;

  sqlite3* connection_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace reident::storage::sql
