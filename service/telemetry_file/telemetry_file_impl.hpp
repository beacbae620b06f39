// What a TelemetryFile holds: telemetry_file.cpp reads, telemetry_file_words.cpp says what was
// found. Private to this folder.
#pragma once

#include "service/telemetry_file/head_checks.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file {

struct TelemetryFile::Impl {
  Impl(TextSource source, ReadingOptions chosen)
      : options(std::move(chosen)), rows(std::move(source)) {}

  ReadingOptions options;
  RowReader rows;
  Dialect dialect;
  std::optional<MadeOf> made_of;
  std::size_t rows_read = 0;
  NumberStyle style;
  std::vector<CellFormat> formats;
  // The head, kept for finding the time.
  std::string head_text;  // its cells, one after the other
  std::vector<std::vector<std::string_view>> head_columns;
  std::vector<std::uint64_t> head_lines;
  std::optional<Clock> clock;
  std::optional<Clock> clock_at_start;  // before any row
  std::optional<ClockWatch> watch;
  std::optional<ClockStep> step;
  std::int64_t ahead_ns = 0;  // of a clock that goes on where it left off
  std::int64_t time_ns = 0;
  bool is_cut_left_out = false;
  std::uint64_t cut_number_line = 0;  // of the last row, where its last cell is cut; 0: it is not
  std::vector<SpacecraftColumn> spacecraft;
  Error error;
  Damage damage = Damage::none;

  std::optional<Error> start();
  /// The line of the file that a cell of a row comes from; `own` is that of the row in the text.
  std::uint64_t line_of(std::size_t row, std::size_t column, std::uint64_t own) const;
  std::uint64_t line_of(std::size_t row, std::uint64_t own) const;
  std::optional<Error> find_cells();
  Step fail(Damage what, Error why) {
    damage = what;
    error = std::move(why);
    return Step::error;
  }
  std::vector<std::string> other_readings() const;
  std::vector<std::string> other_spacecraft() const;
  bool is_another_header(std::span<const std::string_view> cells) const;
  bool has_other_units() const;
  Step fail_at_header();
  bool leaves_out_cut_row();
  /// What the row, or a comment above it, says of all rows below it that was not so before.
  std::optional<Error> of_another_file() const;
  void start_watch();
  void follow(std::int64_t clock_ns);
  Step read_time();
};

}  // namespace reident::telemetry_file
