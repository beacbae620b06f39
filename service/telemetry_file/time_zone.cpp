#include "service/telemetry_file/time_zone.hpp"

#include <array>
#include <chrono>
#include <stdexcept>

#include <date/tz.h>

#include "service/support/floor_divide.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::int64_t gps_epoch_s = 315'964'800;  // 1980-01-06

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
  std::int64_t result = utc(info.first);
  if (info.result == date::local_info::ambiguous) {
    const std::int64_t later = utc(info.second);
    const bool is_later =
        is_newest_first_ ? !last_ns_ || later < *last_ns_ : last_ns_ && result <= *last_ns_;
    if (is_later) result = later;
  }
  last_ns_ = result;
  return result;
}

std::int64_t utc_of_gps(std::int64_t gps_ns) {
  std::int64_t utc = gps_ns + gps_epoch_s * second_ns;
  std::int64_t ahead = 0;
  for (const std::int64_t leap : leaps)
    if (utc - (ahead + 1) * second_ns >= leap * second_ns) ++ahead;
  return utc - ahead * second_ns;
}

std::optional<std::int64_t> utc_of_gps_date(std::int64_t date_ns) {
  std::int64_t gps_ns = 0;
  if (__builtin_sub_overflow(date_ns, gps_epoch_s * second_ns, &gps_ns)) return std::nullopt;
  return utc_of_gps(gps_ns);
}

}  // namespace reident::telemetry_file
