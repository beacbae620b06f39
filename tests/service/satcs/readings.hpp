// What a simulated spacecraft reads, second by second.
#pragma once

#include <algorithm>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::satcs::test {

/// The readings of so many seconds, a vector of samples each.
template <class Spacecraft>
std::vector<std::vector<storage::Sample>> readings(Spacecraft spacecraft, int seconds) {
  std::vector<std::vector<storage::Sample>> result(static_cast<std::size_t>(seconds));
  for (auto& reading : result) {
    spacecraft.read(reading);
    spacecraft.advance();
  }
  return result;
}

inline bool same(const std::vector<storage::Sample>& a, const std::vector<storage::Sample>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.parameter == y.parameter && x.quality == y.quality && x.value == y.value;
  });
}

}  // namespace reident::satcs::test
