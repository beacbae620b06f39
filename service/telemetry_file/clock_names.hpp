// What the names of columns say about times.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/telemetry_file/clock.hpp"

namespace reident::telemetry_file {

/// What a column's name, and its unit where there is a row of units, say about its numbers.
struct NameHint {
  std::optional<std::int64_t> unit_ns;
  std::optional<TimeFormat> format;
  std::optional<std::int64_t> epoch_ns;  // of "seconds since 2000-01-01 00:00:00"
  std::string since;                     // an epoch that is not that sure, as J2000
  std::string unknown_unit;              // what stands in brackets, or in the row of units, as hl
};
NameHint hint_of(std::string_view name, std::string_view unit);

/// What a column's name, or its unit, says about the clock of its dates: "Zeit (MEZ)",
/// "time [Europe/Berlin]", "local time".
struct ZoneHint {
  std::string name;                       // as it stands there
  std::optional<std::int64_t> offset_ns;  // east of UTC; absent: a zone of the database
  bool is_local = false;                  // a local clock, and nothing says where
};
std::optional<ZoneHint> zone_hint_of(std::string_view name, std::string_view unit);

/// What stands in brackets behind a name, or as its unit, as a zone would that is not known here,
/// as IST or Pacific Time; else empty.
std::string unknown_zone_of(std::string_view name, std::string_view unit);

/// What a line above the header says about the clock of all dates, as "Timezone;Europe/Berlin",
/// "GMT+2" and "All times are CET"; local where it says a zone that is not known here.
std::optional<ZoneHint> zone_hint_of_line(std::string_view line);

/// 2000-01-01T12:00:00 [ns since 1970], which is J2000 in TT and TDB.
inline constexpr std::int64_t j2000_ns = 946'728'000'000'000'000;

/// "GPS", "TAI", "TT" or "TDB" where a column of dates is named so; else empty.
std::string time_scale_of(std::string_view name, std::string_view unit);

/// Whether a line above the header is about the time scale of all times, as "TIME_SYSTEM = TAI".
bool says_time_scale(std::string_view line);

/// Whether a column is named as one of minutes and seconds, as "Elapsed (mm:ss)".
bool counts_minutes(std::string_view name);

/// Whether a column is named as one of days of the year.
bool is_day_of_year(std::string_view name);

/// Whether a column is named as one of zones or offsets.
bool is_named_like_a_zone(std::string_view name);

/// Whether a word in front of a zone says that it is one: zone too, which in a column's name may be
/// one of a heater.
bool is_zone_key(std::string_view name);

/// The unit of a column that is called ms, usec, nanoseconds or the like, and nothing else but what
/// the column of seconds is called too, as stamp.secs and stamp.nsecs.
std::optional<std::int64_t> fraction_of_second(std::string_view name, std::string_view seconds);

/// Whether a column is called sec, fraction, subsecond or the like.
bool is_named_like_a_part_of_second(std::string_view name);

/// Whether a column is named as one of spacecraft. Numbers have to be called so: `sat` alone may
/// count them.
bool is_named_like_a_spacecraft(std::string_view name, bool holds_numbers);

/// Whether a column is named as times are.
bool is_named_like_a_time(std::string_view name);

/// Whether two names share a word.
bool are_named_alike(std::string_view name, std::string_view other);

/// What a column is a part of a time by its name.
enum class TimePart {
  none,
  year,
  month,
  day,
  day_of_year,
  hour,
  minute,
  second,
  second_of_day,
  millisecond_of_day,
  date,
  clock,
  gps_week,
  week_second,
};
TimePart part_of(std::string_view name);

}  // namespace reident::telemetry_file
