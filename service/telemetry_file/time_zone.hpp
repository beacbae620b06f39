// Local times of a zone, with its daylight changes, as UTC; and leap seconds of GPS.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace reident::telemetry_file {

/// A zone of the system's database, such as Europe/Berlin.
class TimeZone {
 public:
  /// Absent where the database has no such zone.
  static std::optional<TimeZone> named(const std::string& name);

  /// Returns the UTC time of a local one [ns since 1970]; empty in the hour that a change leaves
  /// out. Of the two in an hour that comes twice, the first one behind the last result, else the
  /// later one; where the newest comes first, the last one before it, else the earlier one.
  std::optional<std::int64_t> to_utc(std::int64_t local_ns);
  void put_newest_first() { is_newest_first_ = true; }

 private:
  const void* zone_ = nullptr;
  bool is_newest_first_ = false;
  std::optional<std::int64_t> last_ns_;
};

/// Returns UTC for GPS seconds [ns since 1980-01-06, leap seconds not left out].
std::int64_t utc_of_gps(std::int64_t gps_ns);
/// Returns UTC for a date of GPS, which is as many leap seconds ahead [ns since 1970]; empty
/// outside 64 bits.
std::optional<std::int64_t> utc_of_gps_date(std::int64_t date_ns);

}  // namespace reident::telemetry_file
