// A file of telemetry as people have it: the one reader of `reident import`, `reident identify` and
// `satcs-replay`.
//
//   dialect -> rows -> time columns -> cells
//
// The first MiB of the text decides how all of it is read; found() says what was found. What does
// not agree with that behind it is a bad row or a bad cell at its line, never another reading.
// Every error is a value that names the file, the line, what is wrong and the option that mends it.
// Nothing here throws but std::bad_alloc. Files are opened for reading alone.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>

#include "service/telemetry_file/cell_format.hpp"
#include "service/telemetry_file/clock.hpp"
#include "service/telemetry_file/clock_watch.hpp"
#include "service/telemetry_file/dialect.hpp"

namespace reident::telemetry_file {

/// What is given of a file; all else is found.
struct ReadingOptions {
  std::optional<std::string> encoding;
  DialectOptions dialect;
  CellOptions cells;
  TimeOptions time;
  std::optional<std::string> spacecraft;  // what the file says otherwise is told
  bool force_times = false;        // times are taken as they are, whatever speaks against them
  bool any_epoch = false;          // nobody has to know since when times count
  bool clock_may_go_back = false;  // a clock that looks set back, restarted or wrapped is no error
  bool continues_clock = false;    // behind a wrap or an hour set back it goes on where it left off
  /// Times behind it are taken for mistakes: those of tomorrow.
  std::int64_t latest_ns = std::numeric_limits<std::int64_t>::max();
};

/// What is said of a text that stands for another one.
struct MadeOf {
  std::string found;                 // what was found there
  std::vector<std::string> remarks;  // what was passed over there, one sentence each
  /// By row and column, the line there that a cell comes from; 0 for one that comes from none. A
  /// row has one at least.
  std::vector<std::vector<std::uint64_t>> lines;
};

class TelemetryFile {
 public:
  /// Opens a file and finds all but its time. An error where it cannot be read or understood.
  static std::variant<TelemetryFile, Error> open(const std::filesystem::path& path,
                                                 const ReadingOptions& options);
  /// Reads `text` itself; `name` stands for the file in messages, whose lines are those of
  /// `made_of` where there is one.
  static std::variant<TelemetryFile, Error> of_text(std::string text, std::string name,
                                                    const ReadingOptions& options,
                                                    std::optional<MadeOf> made_of = {});
  ~TelemetryFile();
  TelemetryFile(TelemetryFile&&) noexcept;
  TelemetryFile& operator=(TelemetryFile&&) noexcept;

  /// Names of the columns in the order of the file; no two are equal but empty ones.
  const std::vector<std::string>& columns() const;
  const CellFormat& format(std::size_t column) const;
  /// The unit of a column by the row of units or behind its numbers; empty: not known.
  std::string unit(std::size_t column) const;
  /// Where a column stands; the error names the columns that exist.
  std::variant<std::size_t, Error> find(std::string_view column) const;
  /// Whether a blank is no sample, since the file held one sample a row (long_layout.hpp).
  bool has_samples_of_their_own() const;
  /// One sentence for each column that holds something and has no name.
  std::vector<std::string> unnamed_columns() const;
  /// Whether the head holds a row.
  bool has_rows() const;
  /// The line of the first cell in the head that a column of text holds, and the cell.
  std::string first_word(std::size_t column) const;

  /// Finds the time of rows; from then on each row has one. An error where no column is a time. The
  /// clock of a file that holds one series after another goes back where the next one begins. Where
  /// rows are to be `of_one_spacecraft`, and a column names several, that is an error too.
  std::optional<Error> find_time(bool is_series_after_series = false,
                                 bool of_one_spacecraft = true);
  const Clock& clock() const;
  bool is_time(std::size_t column) const;

  /// What was found, on one line: "semicolons, decimal commas, header in line 3, time: day of
  /// year".
  std::string found() const;
  /// What next() passed over, and what the file says of its spacecraft: headers again, a cut last
  /// line, a clock that goes ahead an hour; one sentence each.
  std::vector<std::string> remarks() const;

  using Step = RowReader::Step;
  /// Reads the next row. An error where it cannot be read, its time is none, before 1990 or of
  /// after tomorrow, or the clock was set back (ReadingOptions).
  Step next();
  /// After a row: its cells as text, valid until the next call of next().
  std::span<const std::string_view> cells() const;
  Cell cell(std::size_t column) const;
  std::int64_t time_ns() const;  // after find_time()
  /// After a row: the step where its clock is behind that of the row before.
  const std::optional<ClockStep>& clock_step() const;
  std::uint64_t line() const;
  std::uint64_t line(std::size_t column) const;  // of the cell, where cells of a row have their own
  const Error& error() const;
  /// After an error: what is wrong with the row alone, so that next() goes on behind it; else none.
  Damage damage() const;
  Error error_here(std::string_view what) const;  // "FILE:LINE: what"
  Error cell_error(std::size_t column, std::string_view what) const;

  std::uint64_t bytes_read() const;  // of the text, up to the end of the last row
  std::uint64_t next_line() const;
  /// Goes on `position` bytes into the text, where a row starts on line `line`: what bytes_read()
  /// and next_line() said after a row. An error where the file cannot be read from there.
  std::optional<Error> go_on_at(std::uint64_t position, std::uint64_t line);
  std::uint64_t size() const;  // bytes of the file

 private:
  struct Impl;
  explicit TelemetryFile(std::unique_ptr<Impl> impl);
  static std::variant<TelemetryFile, Error> start(TextSource source, const ReadingOptions& options);
  std::unique_ptr<Impl> impl_;
};

/// Rows that were left out, counted by what is wrong with them, each with its first line.
class LeftOut {
 public:
  void add(Damage damage, const Error& error);
  std::uint64_t count() const;
  /// "3 rows left out: 2 with another number of cells (first: FILE:7: ...), 1 ...".
  std::vector<std::string> sentences() const;

 private:
  struct Kind {
    Damage damage;
    std::uint64_t count;
    std::string first;
  };
  std::vector<Kind> kinds_;
};

}  // namespace reident::telemetry_file
