#pragma once

#include <cstdint>

namespace reident {

/// The greatest integer not above a / b, for b > 0: times before 1970 count on in the same grid.
constexpr std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace reident
