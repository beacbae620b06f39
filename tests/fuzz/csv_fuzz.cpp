// Any text is either rows of as many cells as there are columns, or an error with a message; and
// the rows, written as CSV again, are read as the same cells.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "service/support/csv.hpp"
#include "service/support/time_text.hpp"

namespace {

using reident::csv::Reader;
using Rows = std::vector<std::vector<std::string>>;

void require(bool condition) {
  if (!condition) std::abort();
}

/// The rows up to the end or the first error.
Rows rows_of(Reader& reader) {
  Rows rows{{reader.columns()}};
  std::uint64_t line = 0;
  std::uint64_t bytes = 0;
  Reader::Step step = reader.next();
  for (; step == Reader::Step::row; step = reader.next()) {
    require(reader.cells().size() == reader.columns().size());
    require(reader.line() > line && reader.bytes_read() > bytes);
    require(reader.bytes_read() <= reader.size());
    line = reader.line();
    bytes = reader.bytes_read();
    rows.emplace_back(reader.cells().begin(), reader.cells().end());
  }
  require(step == Reader::Step::end || !reader.error().message.empty());
  return rows;
}

std::string written(const Rows& rows) {
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += c == 0 ? "\"" : ",\"";
      for (const char letter : row[c])
        text += letter == '"' ? std::string("\"\"") : std::string(1, letter);
      text += '"';
    }
    text += '\n';
  }
  return text;
}

void check_cell(const std::string& cell) {
  if (const auto number = reident::csv::to_number(cell)) require(std::isfinite(*number));
  if (const auto time = reident::parse_time(cell)) {
    require(reident::parse_time(reident::time_text(*time)) == time);
  }
  if (const auto duration = reident::parse_duration(cell)) {
    require(reident::parse_duration(reident::duration_text(*duration)) == duration);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  auto opened = Reader::from_text(std::move(text), "fuzz");
  if (const auto* error = std::get_if<reident::csv::Error>(&opened)) {
    require(!error->message.empty());
    return 0;
  }
  const Rows rows = rows_of(std::get<Reader>(opened));
  for (const auto& row : rows) {
    for (const auto& cell : row) check_cell(cell);
  }
  auto again = Reader::from_text(written(rows), "again");
  require(std::holds_alternative<Reader>(again));
  require(rows_of(std::get<Reader>(again)) == rows);
  return 0;
}
