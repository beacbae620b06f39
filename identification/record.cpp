#include "identification/record.hpp"

#include <algorithm>
#include <utility>

namespace reident::identification {

Record contiguous_record(double period_s, Matrix u, Matrix y) {
  eigen_assert(u.rows() == y.rows());
  Record record{period_s, std::move(u), std::move(y), {}};
  if (record.rows() > 0) record.segments.push_back({0, record.rows(), 0});
  return record;
}

std::vector<Segment> segments_within(const Record& record, RowRange rows) {
  std::vector<Segment> parts;
  for (const Segment& segment : record.segments) {
    const Index begin = std::max(segment.begin, rows.begin);
    const Index end = std::min(segment.end, rows.end);
    if (begin < end) parts.push_back({begin, end, segment.first_tick + (begin - segment.begin)});
  }
  return parts;
}

Index first_row_at(const Record& record, std::int64_t tick) {
  const auto segment =
      std::partition_point(record.segments.begin(), record.segments.end(),
                           [tick](const Segment& s) { return s.first_tick + s.size() <= tick; });
  if (segment == record.segments.end()) return record.rows();
  return segment->begin + std::max<Index>(0, tick - segment->first_tick);
}

}  // namespace reident::identification
