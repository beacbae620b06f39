// Times and durations as text, exact to the nanosecond: nothing here passes through a double.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident {

/// Nanoseconds since 1970-01-01T00:00:00 UTC from any of
///   1234553735.093, 1.5e9                decimal seconds since that instant
///   2023-04-29, 2023-04-29T16:22[:37[.5]][Z|+03:00|-0300], also with a blank for the T
///   2023/3/2 00:00[:00[.5]]              year first; UTC unless an offset says otherwise
/// with blanks around. Digits below a nanosecond are rounded; the second 60 is the next minute's 0.
/// Empty when the text is none of these or lies outside the years that 64 bits can hold
/// (1677-09-22 to 2262-04-11).
std::optional<std::int64_t> parse_time(std::string_view text);

/// Nanoseconds since 1970 of a decimal number of units that are counted from `origin_s` seconds
/// before 1970, exact but for digits below a nanosecond. Empty when the text is no number or 64
/// bits cannot hold the time. Requires a positive unit.
std::optional<std::int64_t> parse_count(std::string_view text, std::int64_t unit_ns,
                                        std::int64_t origin_s = 0);

/// A time as parse_time() reads it, "now", or how long before `now`: "-2h", "-30min".
std::optional<std::int64_t> parse_moment(std::string_view text, std::int64_t now_ns);

/// Nanoseconds from "250ns", "10us", "500ms", "2.5s", "90min", "2h", "3d" or plain seconds. It may
/// be negative. Empty when the text is none of these or 64 bits cannot hold it.
std::optional<std::int64_t> parse_duration(std::string_view text);

/// "2023-04-29T16:22:37.5Z": as many decimals as the time has. parse_time gives the time back.
std::string time_text(std::int64_t time_ns);

/// The largest unit that divides it: "90min", "1500ms", "0s". parse_duration gives it back.
std::string duration_text(std::int64_t duration_ns);

/// For people: the largest unit alone, as in "12s", "5min", "3h", "4d", "2y".
std::string rough_duration_text(std::int64_t duration_ns);

}  // namespace reident
