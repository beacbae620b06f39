#include "storage/sql/utc_bounds.hpp"

#include <numeric>

#include "storage/types/time_ends.hpp"
#include "storage/types/utc_text.hpp"

namespace reident::storage::sql {

std::optional<Time> first_time_from(std::string_view text) {
  Time low = earliest_time;  // the answer is in [low, high]
  Time high = latest_time;
  if (utc_text(high) < text) return std::nullopt;
  while (low < high) {
    const Time middle = std::midpoint(low, high);
    if (utc_text(middle) < text) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace reident::storage::sql
