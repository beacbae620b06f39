// Random systems and records for properties.
#pragma once

#include <cstdint>
#include <vector>

#include <rapidcheck.h>

#include "tests/support/systems.hpp"

namespace reident::test {

/// Any of [begin, end), as often in the first cases as in the last: rc::gen::inRange starts with
/// the smallest ones and grows.
template <typename Integer>
Integer any_of(Integer begin, Integer end) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(begin, end));
}

struct SettingLimits {
  int order = 12, inputs = 6, outputs = 4;
  double max_modulus = 0.9;
};

/// A random system within the limits, and the noise to excite it with.
struct Setting {
  StateSpaceModel truth;
  Noise noise;
};
Setting any_setting(const SettingLimits& limits);

/// Cuts the record into at most `parts` segments, as if from 1 to 5000 rows had been lost before
/// each.
void cut(Record& record, int parts);

/// The last segment first, with 10 ticks lost between one and the next.
Record with_segments_reversed(const Record& record);

/// The rows for which `wanted(tick)` holds.
template <typename Wanted>
Record rows_where(const Record& record, const Wanted& wanted) {
  std::vector<Index> rows;
  std::vector<identification::Segment> segments;
  for (const auto& segment : record.segments)
    for (Index r = segment.begin; r < segment.end; ++r) {
      const std::int64_t tick = segment.first_tick + (r - segment.begin);
      if (!wanted(tick)) continue;
      const Index at = static_cast<Index>(rows.size());
      if (segments.empty() || segments.back().first_tick + segments.back().size() != tick)
        segments.push_back({at, at, tick});
      segments.back().end = at + 1;
      rows.push_back(r);
    }
  return {record.period_s, record.u(rows, Eigen::all), record.y(rows, Eigen::all), segments};
}

}  // namespace reident::test
