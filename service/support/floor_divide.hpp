// Whole-number division on a grid of time.
#pragma once

#include <cstdint>

namespace reident {

/// Returns the greatest integer not above a / b: times before 1970 count on in the same grid, where
/// `/` would round them up. Requires b > 0.
constexpr std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace reident
