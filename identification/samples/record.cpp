#include "identification/samples/record.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace reident::identification {

Record contiguous_record(double period_s, Matrix u, Matrix y) {
  assert(u.rows() == y.rows());
  Record record{period_s, std::move(u), std::move(y), {}};
  if (record.rows() > 0) record.segments.push_back({0, record.rows(), 0});
  return record;
}

std::vector<Segment> segments_within(const std::vector<Segment>& segments, RowRange rows) {
  std::vector<Segment> parts;
  auto segment = std::partition_point(segments.begin(), segments.end(),
                                      [rows](const Segment& s) { return s.end <= rows.begin; });
  for (; segment != segments.end() && segment->begin < rows.end; ++segment) {
    const Index begin = std::max(segment->begin, rows.begin);
    const Index end = std::min(segment->end, rows.end);
    if (begin < end) parts.push_back({begin, end, segment->tick_of(begin)});
  }
  return parts;
}

std::vector<Segment> segments_within(const Record& record, RowRange rows) {
  return segments_within(record.segments, rows);
}

std::vector<Segment> segments_from(const Record& record, RowRange rows) {
  std::vector<Segment> parts = segments_within(record, rows);
  for (Segment& part : parts) {
    part.begin -= rows.begin;
    part.end -= rows.begin;
  }
  return parts;
}

std::vector<RowRange> ranges_from(const Record& record, RowRange rows) {
  std::vector<RowRange> ranges;
  for (const Segment& part : segments_within(record, rows))
    ranges.push_back({part.begin - rows.begin, part.end - rows.begin});
  return ranges;
}

Record rows_at(const Record& record, TickRange ticks) {
  const RowRange rows{first_row_at(record, ticks.begin), first_row_at(record, ticks.end)};
  return {record.period_s, record.u.middleRows(rows.begin, rows.size()),
          record.y.middleRows(rows.begin, rows.size()), segments_from(record, rows)};
}

Index first_row_at(const Record& record, std::int64_t tick) {
  const auto segment =
      std::partition_point(record.segments.begin(), record.segments.end(),
                           [tick](const Segment& s) { return s.end_tick() <= tick; });
  if (segment == record.segments.end()) return record.rows();
  return tick <= segment->first_tick ? segment->begin
                                     : segment->begin + (tick - segment->first_tick);
}

double resolution(Vector channel) {
  std::sort(channel.begin(), channel.end());
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 1; i < channel.size(); ++i)
    if (const double change = channel(i) - channel(i - 1); change > 0)
      least = std::min(least, change);
  return std::isfinite(least) ? least : 0;
}

std::int64_t tick_of_row(const Record& record, Index row) {
  assert(record.rows() > 0 && row >= 0 && row <= record.rows());
  if (row == record.rows()) return record.segments.back().end_tick();
  return std::partition_point(record.segments.begin(), record.segments.end(),
                              [row](const Segment& s) { return s.end <= row; })
      ->tick_of(row);
}

}  // namespace reident::identification
