// Local times of a zone, with its daylight changes, as UTC; and leap seconds of GPS.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident::telemetry_file {

/// A zone of the system's database, such as Europe/Berlin.
class TimeZone {
 public:
  /// Absent where the database has no such zone.
  static std::optional<TimeZone> named(const std::string& name);

  /// Returns the UTC time of a local one [ns since 1970]; empty in the hour that a change leaves
  /// out. An hour that comes twice is the first one until the clock goes back by about an hour in
  /// it, less a step: rows of one time, or a little out of order, stay in the same. Where the
  /// newest comes first it is the second one until the clock goes ahead so.
  std::optional<std::int64_t> to_utc(std::int64_t local_ns);
  void put_newest_first() { is_newest_first_ = true; }

 private:
  const void* zone_ = nullptr;
  bool goes_over(std::int64_t local_ns);

  bool is_newest_first_ = false;
  bool is_in_other_ = false;  // of the two hours, in the one that comes later in the file
  std::optional<std::int64_t> last_ns_;  // local
  std::int64_t usual_ns_ = 0;            // the last step on
};

/// 1980-01-06 [ns since 1970].
inline constexpr std::int64_t gps_epoch_ns = 315'964'800'000'000'000;
/// Returns UTC for GPS seconds [ns since 1980-01-06, leap seconds not left out].
std::int64_t utc_of_gps(std::int64_t gps_ns);
/// Returns UTC for a date of GPS, which is as many leap seconds ahead [ns since 1970]; empty
/// outside 64 bits.
std::optional<std::int64_t> utc_of_gps_date(std::int64_t date_ns);

/// How far a time scale, GPS, TAI, TT or TDB, is ahead of UTC at a time [ns].
std::int64_t ahead_of_utc(std::string_view scale, std::int64_t utc_ns);

/// Whether a time is within the second behind a leap second, which has no number of its own.
bool follows_leap_second(std::int64_t utc_ns);
/// Returns the place of a time in a leap second, which counted on would be in the second behind it:
/// the last millisecond before that, a thousand times shorter, so that no other time is there.
std::int64_t place_in_leap_second(std::int64_t utc_ns);

}  // namespace reident::telemetry_file
