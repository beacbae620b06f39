// A plain user of SQLite who loaded the extension.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sqlite3.h>

namespace reident::storage::test {

class SqlUser {
 public:
  /// Opens for reading and writing: temporary tables aside, nothing here writes.
  explicit SqlUser(const std::filesystem::path& database);

  /// One string a row, columns separated by '|', doubles with all their digits. An error is the
  /// last string: "error CODE: message".
  std::vector<std::string> ask(const std::string& sql) const;

  /// Calls `use` with the statement at each row. The error, where there is one: "error CODE: ...".
  std::optional<std::string> each_row(const std::string& sql,
                                      const std::function<void(sqlite3_stmt*)>& use) const;

  sqlite3* handle() const { return handle_.get(); }

 private:
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, &sqlite3_close};
};

}  // namespace reident::storage::test
