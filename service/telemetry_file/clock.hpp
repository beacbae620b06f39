// The time of a row, from one column or several, in any of the forms that people have.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/telemetry_file/cell_format.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/time_zone.hpp"

namespace reident::telemetry_file {

/// What a column of times holds. Texts are dates and times (date_text.hpp).
enum class TimeFormat {
  mixed,     // seconds since 1970, or a date and time; whole numbers of 17 digits are nanoseconds
  text,      // a date and time, by its own offset, the zone, or else UTC
  unix,      // numbers of a unit since 1970
  elapsed,   // numbers of a unit since an epoch that is given, or not known
  excel,     // days since 1899-12-30
  mjd,       // modified Julian days
  jd,        // Julian days
  matlab,    // days of datenum
  filetime,  // 100 ns since 1601
  dotnet,    // 100 ns since the year 1
  gps,       // seconds since 1980-01-06, leap seconds not left out
};
std::optional<TimeFormat> parse_time_format(std::string_view text);
std::string time_format_names();

/// Nanoseconds of a unit "ns", "us", "ms", "s", "min", "h" or "d", or of so many of it as in
/// "10ms"; empty for anything else.
std::optional<std::int64_t> parse_time_unit(std::string_view text);

struct TimeOptions {
  /// A column, or several separated by commas; absent: those that look like a time.
  std::optional<std::string> column;
  std::optional<TimeFormat> format;
  std::optional<DateOrder> order;
  std::optional<std::int64_t> unit_ns;
  std::optional<std::string> zone;
  std::optional<std::int64_t> epoch_ns;  // of elapsed times
};

struct NumberedLine;  // row_reader.hpp

/// The cells of the head of a file, column by column, and the line of each.
struct HeadCells {
  const std::vector<std::string>& names;
  const std::vector<std::string>& units;  // empty: none
  std::span<const std::vector<std::string_view>> columns;
  std::span<const std::uint64_t> lines;
  NumberStyle style;
  std::span<const NumberedLine> above;  // lines above the header
};

/// Reads times. The times before decide which of two equal hours a local time is in: rows are read
/// in order.
class Clock {
 public:
  /// Finds what the time of a row is. An error text where there is none, the options do not go with
  /// the cells, or cells may be read in two ways; with the line of the cell that shows it, or 0.
  struct Problem {
    std::uint64_t line = 0;
    std::string text;
  };
  static std::variant<Clock, Problem> find(const HeadCells& head, const TimeOptions& options,
                                           std::int64_t latest_ns);

  /// The time of the row with these cells [ns since 1970, or since the epoch that is not known];
  /// empty where it is none.
  std::optional<std::int64_t> read(std::span<const std::string_view> cells);

  /// Positions of the columns that it reads; the first names it in messages.
  const std::vector<std::size_t>& columns() const { return columns_; }
  /// Whether it reads a column, as one of those or for the zone or the part of a second.
  bool uses(std::size_t column) const;
  /// Whether times are since 1970, and not since an epoch that nobody gave.
  bool is_absolute() const { return !counts_ || epoch_ns_; }
  /// Since when numbers or times of day count [ns]; absent: times are dates, and wrap at nothing.
  std::optional<std::int64_t> counts_since() const {
    return counts_ ? std::optional(epoch_ns_.value_or(0)) : std::nullopt;
  }
  /// Whether texts are of a clock that nobody named: it may be a local one.
  bool may_be_local() const { return may_be_local_; }
  /// Whether lines above the header say the zone of all times, or could say it.
  bool is_of_lines() const { return may_be_local_ || is_zone_of_lines_; }
  /// What says that it is a local one, and not where, as "column 'local_time'"; empty: nothing
  /// does.
  const std::string& local_by() const { return local_by_; }
  std::int64_t unit_ns() const { return unit_ns_; }
  /// Whether most rows of the head are earlier than the one before.
  bool is_newest_first() const { return is_newest_first_; }
  /// Whether the times of rows before decide what a cell means.
  bool depends_on_order() const { return zone_.has_value(); }
  /// "day of year", "milliseconds since 1970 by the name".
  const std::string& description() const { return description_; }

 private:
  enum class Parts { one, joined, dated, calendar, day_of_year, gps_week, day_count };
  friend class ClockFinder;

  std::optional<std::int64_t> read_one(std::string_view cell);
  std::optional<std::int64_t> read_parts(std::span<const std::string_view> cells);
  std::optional<std::int64_t> read_number_of(std::string_view cell) const;
  std::optional<std::int64_t> absolute(const DateText& text);
  std::optional<std::int64_t> counted_on(const DateText& text);  // a leap second is the next one
  std::string clock_text(std::string_view cell) const;

  std::vector<std::size_t> columns_;
  Parts parts_ = Parts::one;
  TimeFormat format_ = TimeFormat::mixed;
  DateOrder order_ = DateOrder::day_first;
  std::int64_t unit_ns_ = 1'000'000'000;
  std::vector<std::int64_t> part_unit_ns_;  // of hours, minutes, seconds behind the date's parts
  std::optional<std::int64_t> epoch_ns_;    // of counts and times of day; absent: nobody gave one
  std::int64_t quantum_ns_ = 1;             // what days, hours and minutes are rounded to
  std::size_t clock_digits_ = 0;   // of a time of day as a number, as 93000; 0: it is no number
  bool adds_clock_ = false;        // dates have a clock, which shows midnight in all rows
  bool counts_first_day_ = false;  // times of day have the day of the year, and no year
  bool counts_minutes_ = false;    // a clock of two parts is minutes and seconds
  bool is_gps_date_ = false;       // dates are those of GPS
  bool has_decimal_comma_ = false;
  bool has_unit_behind_ = false;  // numbers are as "10 sec"
  bool counts_ = false;           // times are numbers since something, or times of day
  bool may_be_local_ = false;
  bool is_zone_of_lines_ = false;
  bool is_newest_first_ = false;
  std::string local_by_;
  std::optional<TimeZone> zone_;
  std::optional<std::int64_t> offset_ns_;       // of texts without their own, where it is said
  std::optional<std::size_t> zone_column_;      // or by this column of each row
  std::optional<std::size_t> fraction_column_;  // parts of a second
  std::int64_t fraction_unit_ns_ = 0;
  std::string description_;
};

}  // namespace reident::telemetry_file
