#include "identification/samples/tick_ranges.hpp"

#include <algorithm>
#include <limits>

namespace reident::identification {
namespace {

constexpr std::int64_t least_tick = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest_tick = std::numeric_limits<std::int64_t>::max();

}  // namespace

TickSet united(std::vector<TickRange> ranges) {
  std::erase_if(ranges, [](const TickRange& range) { return range.begin >= range.end; });
  std::sort(ranges.begin(), ranges.end(),
            [](const TickRange& a, const TickRange& b) { return a.begin < b.begin; });
  TickSet set;
  for (const TickRange& range : ranges) {
    if (set.empty() || set.back().end < range.begin)
      set.push_back(range);
    else
      set.back().end = std::max(set.back().end, range.end);
  }
  return set;
}

TickSet inside(const TickSet& set, TickRange ticks) {
  TickSet result;
  for (const TickRange& range : set) {
    const TickRange common{std::max(range.begin, ticks.begin), std::min(range.end, ticks.end)};
    if (common.begin < common.end) result.push_back(common);
  }
  return result;
}

TickSet outside(const TickSet& set, TickRange ticks) {
  TickSet result = inside(set, {least_tick, ticks.begin});
  const TickSet behind = inside(set, {ticks.end, greatest_tick});
  result.insert(result.end(), behind.begin(), behind.end());
  return result;
}

TickSet differing(const TickSet& one, const TickSet& other) {
  // Where the number of ends passed is odd, a tick is in exactly one of the two.
  std::vector<std::int64_t> ends;
  for (const TickSet* set : {&one, &other})
    for (const TickRange& range : *set) {
      ends.push_back(range.begin);
      ends.push_back(range.end);
    }
  std::sort(ends.begin(), ends.end());
  std::vector<TickRange> ranges;
  for (std::size_t i = 0; i + 1 < ends.size(); i += 2) ranges.push_back({ends[i], ends[i + 1]});
  return united(std::move(ranges));
}

std::int64_t size(const TickSet& set) {
  std::int64_t ticks = 0;
  for (const TickRange& range : set) ticks += range.end - range.begin;
  return ticks;
}

Record without(Record record, const TickSet& holes) {
  if (holes.empty()) return record;
  std::vector<Segment> kept;
  auto hole = holes.begin();
  for (const Segment& segment : record.segments) {
    const std::int64_t end = segment.end_tick();
    std::int64_t tick = segment.first_tick;
    while (tick < end) {
      while (hole != holes.end() && hole->end <= tick) ++hole;
      const bool is_hole = hole != holes.end() && hole->begin <= tick;
      const std::int64_t next =
          hole == holes.end() ? end : std::min(end, is_hole ? hole->end : hole->begin);
      const Index row = segment.begin + (tick - segment.first_tick);
      if (!is_hole) kept.push_back({row, row + (next - tick), tick});
      tick = next;
    }
  }
  Index rows = 0;
  for (const Segment& segment : kept) rows += segment.size();
  Record result{record.period_s, Matrix(rows, record.u.cols()), Matrix(rows, record.y.cols()), {}};
  Index at = 0;
  for (const Segment& segment : kept) {
    result.u.middleRows(at, segment.size()) = record.u.middleRows(segment.begin, segment.size());
    result.y.middleRows(at, segment.size()) = record.y.middleRows(segment.begin, segment.size());
    result.segments.push_back({at, at + segment.size(), segment.first_tick});
    at += segment.size();
  }
  return result;
}

}  // namespace reident::identification
