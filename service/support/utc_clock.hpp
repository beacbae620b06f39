// The machine's clocks. What has to be tested takes a clock as an argument instead.
#pragma once

#include <chrono>
#include <cstdint>

namespace reident {

/// Returns nanoseconds since 1970-01-01T00:00:00 UTC, without leap seconds. An adjustment of the
/// system's clock moves it, backwards too: measure durations with steady_now().
inline std::int64_t utc_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Returns nanoseconds since some moment before the program began; it never goes back.
inline std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace reident
