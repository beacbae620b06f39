#include "service/telemetry_file/time_zone.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <date/tz.h>

#include "service/support/floor_divide.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

/// UTC seconds since 1970 at which GPS became a second more ahead (IERS Bulletin C).
constexpr std::array<std::int64_t, 18> leaps = {
    362'793'600, 394'329'600,   425'865'600,   489'024'000,   567'993'600,   631'152'000,
    662'688'000, 709'948'800,   741'484'800,   773'020'800,   820'454'400,   867'715'200,
    915'148'800, 1'136'073'600, 1'230'768'000, 1'341'100'800, 1'435'708'800, 1'483'228'800};

}  // namespace

std::optional<TimeZone> TimeZone::named(const std::string& name) {
  TimeZone zone;
  try {
    zone.zone_ = date::locate_zone(name);
  } catch (const std::runtime_error&) {  // what the library throws for an unknown name
    return std::nullopt;
  }
  return zone;
}

std::optional<std::int64_t> TimeZone::to_utc(std::int64_t local_ns) {
  const auto* zone = static_cast<const date::time_zone*>(zone_);
  const date::local_seconds second{std::chrono::seconds{floor_divide(local_ns, second_ns)}};
  const date::local_info info = zone->get_info(second);
  if (info.result == date::local_info::nonexistent) return std::nullopt;
  const auto utc = [&](const date::sys_info& at) {
    return local_ns - std::chrono::duration_cast<std::chrono::nanoseconds>(at.offset).count();
  };
  const bool comes_twice = info.result == date::local_info::ambiguous;
  const bool is_changed = goes_over(local_ns);
  is_in_other_ = comes_twice && (is_in_other_ || is_changed);
  return utc(comes_twice && is_in_other_ != is_newest_first_ ? info.second : info.first);
}

/// Whether the clock goes the other way from the last time by about an hour, less a usual step.
bool TimeZone::goes_over(std::int64_t local_ns) {
  constexpr std::int64_t least_ns = 30 * minute_ns;
  const std::int64_t last_ns = std::exchange(last_ns_, local_ns).value_or(local_ns);
  std::int64_t on_ns = 0;
  if (__builtin_sub_overflow(local_ns, last_ns, &on_ns) || on_ns == INT64_MIN) return false;
  if (is_newest_first_) on_ns = -on_ns;
  if (on_ns > 0) {
    usual_ns_ = on_ns;
    return false;
  }
  return usual_ns_ <= hour_ns && usual_ns_ - on_ns >= least_ns;
}

std::int64_t utc_of_gps(std::int64_t gps_ns) {
  std::int64_t utc = gps_ns + gps_epoch_ns;
  std::int64_t ahead = 0;
  for (const std::int64_t leap : leaps)
    if (utc - (ahead + 1) * second_ns >= leap * second_ns) ++ahead;
  return utc - ahead * second_ns;
}

std::optional<std::int64_t> utc_of_gps_date(std::int64_t date_ns) {
  std::int64_t gps_ns = 0;
  if (__builtin_sub_overflow(date_ns, gps_epoch_ns, &gps_ns)) return std::nullopt;
  return utc_of_gps(gps_ns);
}

std::int64_t ahead_of_utc(std::string_view scale, std::int64_t utc_ns) {
  constexpr std::int64_t tai_of_gps_ns = 19 * second_ns, tt_of_tai_ns = 32'184'000'000;
  const auto of_gps = std::count_if(leaps.begin(), leaps.end(), [&](std::int64_t leap) {
    return floor_divide(utc_ns, second_ns) >= leap;
  });
  std::int64_t ahead_ns = of_gps * second_ns;
  if (scale != "GPS") ahead_ns += tai_of_gps_ns;
  if (scale == "TT" || scale == "TDB") ahead_ns += tt_of_tai_ns;
  return ahead_ns;
}

bool follows_leap_second(std::int64_t utc_ns) {
  const std::int64_t second = floor_divide(utc_ns, second_ns);
  return second % 86'400 == 0 && std::find(leaps.begin(), leaps.end(), second) != leaps.end();
}

std::int64_t place_in_leap_second(std::int64_t utc_ns) {
  constexpr std::int64_t place_ns = second_ns / 1000;
  const std::int64_t second = floor_divide(utc_ns, second_ns) * second_ns;
  return second - place_ns + (utc_ns - second) / 1000;
}

}  // namespace reident::telemetry_file
