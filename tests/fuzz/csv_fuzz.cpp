// Any text is either rows of as many cells as there are columns, or an error with a message,
// whatever dialect it is taken for; and the rows, written as CSV again, are read as the same cells.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "service/support/csv.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/encoding.hpp"
#include "service/telemetry_file/long_layout.hpp"
#include "service/telemetry_file/telemetry_file.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace {

using namespace reident::telemetry_file;
using Rows = std::vector<std::vector<std::string>>;

void require(bool condition) {
  if (!condition) std::abort();
}

/// The rows that can be read, the header first.
Rows rows_of(TelemetryFile& file) {
  Rows rows{{file.columns()}};
  std::uint64_t line = 0;
  std::uint64_t bytes = 0;
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    require(file.bytes_read() > bytes);
    bytes = file.bytes_read();
    if (step == TelemetryFile::Step::error) {
      require(!file.error().message.empty());
      if (file.damage() == Damage::none) break;
      continue;
    }
    require(file.cells().size() == file.columns().size());
    require(file.line() > line);
    line = file.line();
    for (std::size_t c = 0; c < file.columns().size(); ++c) file.cell(c);
    rows.emplace_back(file.cells().begin(), file.cells().end());
  }
  return rows;
}

/// As a table of its samples, every cell comes from a line of the text, in whatever encoding.
void check_table(const std::string& path, const std::string& text) {
  auto opened = open_as_table(path, {}, true);
  auto* table = std::get_if<TelemetryFile>(&opened);
  if (!table || !table->has_samples_of_their_own()) return;
  const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n') +
                                                std::count(text.begin(), text.end(), '\r'));
  for (auto step = table->next(); step != TelemetryFile::Step::end; step = table->next()) {
    if (step == TelemetryFile::Step::error && table->damage() == Damage::none) break;
    for (std::size_t c = 0; c < table->columns().size(); ++c)
      require(table->line(c) >= 1 && table->line(c) <= lines + 1);
  }
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

/// Above the first rows, a row of more lines than this is taken for a stray quote.
bool has_long_row(const Rows& rows) {
  constexpr std::ptrdiff_t most_ends = 18;
  return std::any_of(rows.begin(), rows.end(), [](const auto& row) {
    std::ptrdiff_t ends = 0;
    for (const std::string& cell : row) ends += std::count(cell.begin(), cell.end(), '\n');
    return ends > most_ends;
  });
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

/// The C library loads a converter again for each file where none of its kind is in use, which
/// takes longer than reading the file.
std::vector<std::unique_ptr<Decoder>> keep_converters() {
  std::vector<std::unique_ptr<Decoder>> kept;
  for (const char* encoding :
       {"ISO-8859-1", "WINDOWS-1252", "UTF-16LE", "UTF-16BE", "SHIFT_JIS", "GB18030", "BIG5",
        "EUC-KR", "EUC-JP", "WINDOWS-1251", "KOI8-R", "WINDOWS-1253", "WINDOWS-1250"})
    kept.push_back(Decoder::of(encoding));
  return kept;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const reident::test::MemoryFile memory;
  static const auto converters = keep_converters();
  const std::string text(reinterpret_cast<const char*>(data), size);
  memory.write(text);
  auto opened = TelemetryFile::open(memory.path(), {});
  if (const auto* error = std::get_if<Error>(&opened)) {
    require(!error->message.empty());
    return 0;
  }
  const auto& file = std::get<TelemetryFile>(opened);
  if (file.has_rows() && find_long_layout(file)) check_table(memory.path(), text);
  if (std::get<TelemetryFile>(opened).find_time())  // none: its rows alone
    opened = TelemetryFile::open(memory.path(), {});
  const Rows rows = rows_of(std::get<TelemetryFile>(opened));
  for (const auto& row : rows) {
    for (const auto& cell : row) check_cell(cell);
  }
  if (has_long_row(rows)) return 0;
  ReadingOptions commas;
  commas.dialect.separator = ',';
  commas.dialect.header_line = 1;
  commas.dialect.comment = "";
  commas.cells.style = NumberStyle{};
  auto again = TelemetryFile::of_text(written(rows), "again", commas);
  if (std::holds_alternative<Error>(again)) return 0;  // a name holds a line end
  require(rows_of(std::get<TelemetryFile>(again)).size() <= rows.size());
  return 0;
}
