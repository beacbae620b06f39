// Comma-separated values with a header row, read as a stream of rows or as a table of numbers.
//
// Rows end with LF or CRLF; a byte order mark is skipped; a cell in double quotes may hold commas,
// line ends and doubled quotes (RFC 4180). Empty lines are skipped. Blanks around a name or a
// number do not count. A cell that is blank or no finite number ("", "nan", "inf", "n/a") is a
// missing value, never a zero.
//
// Every error is a value. It names the file, the line where there is one, what is wrong and what
// would mend it. Nothing here throws but std::bad_alloc. Files are opened for reading alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace reident::csv {

/// Why a file or a row cannot be read.
struct Error {
  std::string message;  // one line, for a console
};

/// The number in a cell, as in "1.5", " +1.5 " and "1e3"; empty when the value is missing.
std::optional<double> to_number(std::string_view cell);

/// Reads row by row; memory is bounded by the longest row, which may have 16 MiB. One thread at a
/// time. A moved-from reader may only be destroyed or assigned to.
class Reader {
 public:
  /// Opens the file and reads its header row. An error where the file cannot be read, is empty,
  /// packed or UTF-16, where the first row holds numbers alone, or where two columns have one name.
  static std::variant<Reader, Error> open(const std::filesystem::path& path);
  /// Reads `text` itself, in the same way; `name` stands for the file in messages.
  static std::variant<Reader, Error> from_text(std::string text, std::string name);

  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  /// Column names in the order of the file; no two are equal but empty ones.
  const std::vector<std::string>& columns() const;
  /// Where a column stands; the error names the columns that exist.
  std::variant<std::size_t, Error> find(std::string_view column) const;

  enum class Step { row, end, error };
  /// Reads the next row that is not empty. An error where the row cannot be read, or has another
  /// number of cells than the header.
  Step next();
  /// After a row: its cells, one for each column, valid until the next call of next().
  std::span<const std::string_view> cells() const;
  /// After a row: the line of the file on which it starts, from 1.
  std::uint64_t line() const;
  /// After an error: what stopped the reading.
  const Error& error() const;
  /// After an error: whether one row alone is bad, so that next() goes on behind it.
  bool only_row_is_bad() const;
  /// The time in a cell of the row (see time_text.hpp), in nanoseconds since 1970 UTC. Requires a
  /// row, and `column` < columns().size().
  std::variant<std::int64_t, Error> time_at(std::size_t column) const;
  /// An error at the row that was just read: "FILE:LINE: what".
  Error error_here(std::string_view what) const;

  std::uint64_t bytes_read() const;  // up to the end of the last row
  std::uint64_t next_line() const;   // the one that follows it
  /// Goes on `position` bytes into the file, where a row starts on line `line`: what bytes_read()
  /// and next_line() said after a row. Requires a reader of open(). An error where the file cannot
  /// be read from there.
  std::optional<Error> go_on_at(std::uint64_t position, std::uint64_t line);
  std::uint64_t size() const;  // bytes of the whole file; 0 where it cannot be known

 private:
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl);
  static std::variant<Reader, Error> start(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Numbers of whole columns, one vector for each column asked for.
struct Table {
  std::vector<std::vector<double>> values;  // NaN where the value is missing
  std::vector<std::int64_t> time_ns;        // empty without a time column
  std::size_t rows = 0;
};

/// Reads `columns`, in this order, and the time of each row from `time_column` where it is given.
/// An error where the file or a row cannot be read, a column is not there, or a time is none; then
/// nothing is returned of the rows before. All rows are in memory at once.
std::variant<Table, Error> read_table(const std::filesystem::path& path,
                                      std::span<const std::string> columns,
                                      const std::optional<std::string>& time_column = std::nullopt);

}  // namespace reident::csv
