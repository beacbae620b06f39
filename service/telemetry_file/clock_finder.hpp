// Finds which columns hold the time of a row (clock_columns.cpp), what their cells mean
// (clock_finder.cpp), and in which zone and time scale (clock_zones.cpp). Private to this folder.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "service/telemetry_file/clock.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/dialect.hpp"

namespace reident::telemetry_file {

/// Looks at the columns of a head.
class ClockFinder {
 public:
  ClockFinder(const HeadCells& head, const TimeOptions& options, std::int64_t latest_ns)
      : head_(head), options_(options), latest_s_(static_cast<double>(latest_ns) * 1e-9) {}

  std::variant<Clock, Clock::Problem> run();

 private:
  std::optional<std::size_t> column(std::string_view name) const;
  std::optional<std::size_t> part(TimePart part) const;
  std::pair<std::string_view, std::uint64_t> first_cell(std::size_t c) const;
  bool counts_days_of_year(std::size_t c) const;
  bool counts_seconds(std::size_t c) const;
  bool set_parts(Clock::Parts parts, std::vector<std::size_t> columns,
                 std::vector<std::int64_t> units);
  std::vector<std::int64_t> add_time_of_day(std::vector<std::size_t>& columns);
  bool find_calendar();
  bool find_date_and_parts();
  bool find_date_and_clock();
  bool join(std::size_t date, std::optional<std::size_t> clock);
  std::optional<std::size_t> clock_beside(std::size_t date) const;
  void count_clock_digits(std::size_t c);
  bool are_midnights(std::size_t c) const;
  bool find_gps_week();
  bool find_day_count();
  bool set_day_count(std::size_t day, std::size_t of_day);
  bool find_seconds_and_parts();
  std::optional<Clock::Problem> unknown_zone(std::size_t c) const;
  std::optional<Clock::Problem> no_year(std::size_t c) const;
  bool find_set();
  std::string_view unit(std::size_t c) const;
  bool holds_time(std::size_t c) const;
  std::optional<Clock::Problem> choose_columns();
  std::optional<Clock::Problem> choose(std::vector<std::size_t> columns);
  std::optional<Clock::Problem> choose_named(const std::string& asked);
  std::optional<Clock::Problem> decide_parts();
  void take_zone_of_names();
  void take_zone_of_lines();
  void take_zone(const ZoneHint& hint, const std::string& where, std::string_view evidence);
  bool is_newest_first() const;
  std::optional<Clock::Problem> decide_scale(std::size_t c);
  std::optional<Clock::Problem> refuse_scale_of_numbers(std::size_t c, const NameHint& hint,
                                                        double value) const;
  std::string epoch_in_utc(std::string_view scale, const NameHint& hint, double value) const;
  bool find_zone_column();
  void find_fraction_column();
  bool is_part_of_second(std::size_t c) const;
  enum class YearFirst { impossible, possible, alone };
  YearFirst year_first(std::size_t c) const;
  double span(std::size_t c, DateOrder order) const;
  std::optional<Clock::Problem> decide_order(std::size_t c);
  std::optional<Clock::Problem> decide_one(std::size_t c);
  Clock::Problem some_lack_offsets(std::size_t c) const;
  bool are_weeks_apart(const std::vector<double>& values) const;
  bool in_window(const std::vector<double>& values, TimeFormat format, std::int64_t unit_ns) const;
  std::optional<std::int64_t> unit_by_size(const std::vector<double>& values) const;
  bool is_absolute_number(const std::vector<double>& values) const;
  void take(TimeFormat format, std::int64_t unit_ns, int decimals, double value,
            std::string_view evidence);
  Clock::Problem unknown_unit(std::size_t c, std::string_view unit) const;
  std::optional<Clock::Problem> unknown_count(std::size_t c, const NameHint& hint,
                                              const std::vector<double>& values) const;
  std::optional<Clock::Problem> decide_number(std::size_t c, const std::vector<double>& values,
                                              int decimals);

  const HeadCells& head_;
  const TimeOptions& options_;
  const double latest_s_;
  bool is_asked_ = false;                    // the columns were named
  std::optional<std::int64_t> unit_behind_;  // of times as "10 sec"
  Clock clock_;
};

}  // namespace reident::telemetry_file
