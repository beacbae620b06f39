// The ends of what a Time can say, and ranges that reach them.
#pragma once

#include <limits>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

inline constexpr Time earliest_time = std::numeric_limits<Time>::min();
inline constexpr Time latest_time = std::numeric_limits<Time>::max();

/// Holds every time, the latest one too.
inline constexpr TimeRange all_times{earliest_time, latest_time};

/// Just after `time`, for the end of a range.
constexpr Time just_after(Time time) {
  return time == latest_time ? time : time + 1;
}
/// The last time in a range that is not empty.
constexpr Time last_of(TimeRange range) {
  return range.end == latest_time ? latest_time : range.end - 1;
}
/// `by`, which is not negative, before or after `time`; not beyond the ends.
constexpr Time earlier(Time time, Time by) {
  return time < earliest_time + by ? earliest_time : time - by;
}
constexpr Time later(Time time, Time by) {
  return time > latest_time - by ? latest_time : time + by;
}

}  // namespace reident::storage
