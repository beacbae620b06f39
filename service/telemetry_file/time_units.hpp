// Lengths of time [ns].
#pragma once

#include <cstdint>

namespace reident::telemetry_file {

inline constexpr std::int64_t second_ns = 1'000'000'000;
inline constexpr std::int64_t minute_ns = 60 * second_ns;
inline constexpr std::int64_t hour_ns = 60 * minute_ns;
inline constexpr std::int64_t day_ns = 24 * hour_ns;

}  // namespace reident::telemetry_file
