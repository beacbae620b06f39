#include "identification/screening/excursions.hpp"

#include <algorithm>
#include <cmath>

namespace reident::identification {

std::vector<Excursion> excursions_of(const Channel& channel) {
  if (!(channel.greatest_step > channel.least_jump)) return {};
  std::vector<Excursion> found;
  const Vector& values = channel.values;
  for (std::size_t s = 0; s < channel.segments->size(); ++s) {
    const Segment& segment = (*channel.segments)[s];
    for (Index row = segment.begin + 1; row < segment.end; ++row) {
      const double before = values(row - 1), value = values(row);
      if (!(std::abs(value - before) > channel.least_jump)) continue;
      Index end = row + 1;
      while (end < segment.end && values(end) == value) ++end;
      if (end == segment.end) break;
      const double up = value - before, down = value - values(end);
      const double height = std::min(std::abs(up), std::abs(down));
      if (height > channel.least_jump && up * down > 0 &&
          std::abs(values(end) - before) < neighbours_agree * height &&
          (found.empty() || found.back().plateau.end != row))  // else the way back from it
        found.push_back({{row, end, value, s}, up > 0 ? height : -height});
      row = end - 1;
    }
  }
  return found;
}

}  // namespace reident::identification
