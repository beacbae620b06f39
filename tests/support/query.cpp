// query DATABASE SQL: the rows as a plain user who loaded the extension gets them, each a JSON
// array on a line of its own. For tests whose language may not be allowed to load extensions.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/storage/sql/sql_user.hpp"

namespace {

std::string json_of(sqlite3_stmt* statement, int column) {
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_NULL:
      return "null";
    case SQLITE_INTEGER:
      return std::to_string(sqlite3_column_int64(statement, column));
    case SQLITE_FLOAT: {
      const double value = sqlite3_column_double(statement, column);
      if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";  // as Python reads it
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", value);
      return std::string(text).find_first_of(".e") == std::string::npos ? text + std::string(".0")
                                                                        : text;
    }
    default:
      return nlohmann::json(reinterpret_cast<const char*>(sqlite3_column_text(statement, column)))
          .dump();
  }
}

int print_rows(const reident::storage::test::SqlUser& user, const char* sql) {
  const auto error = user.each_row(sql, [](sqlite3_stmt* statement) {
    std::string row;
    for (int i = 0; i < sqlite3_column_count(statement); ++i)
      row += (i > 0 ? ", " : "") + json_of(statement, i);
    std::cout << '[' << row << "]\n";
  });
  if (!error) return 0;
  std::cerr << "query: " << *error << '\n';
  return 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::cerr << "usage: query DATABASE SQL\n";
    return 2;
  }
  try {
    return print_rows(reident::storage::test::SqlUser(arguments[1]), arguments[2]);
  } catch (const std::exception& error) {
    std::cerr << "query: " << error.what() << '\n';
    return 1;
  }
}
