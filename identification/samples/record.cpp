#include "identification/samples/record.hpp"

#include <algorithm>
#include <cassert>
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
    if (begin < end) parts.push_back({begin, end, segment->first_tick + (begin - segment->begin)});
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

Record rows_at(const Record& record, TickRange ticks) {
  const RowRange rows{first_row_at(record, ticks.begin), first_row_at(record, ticks.end)};
  return {record.period_s, record.u.middleRows(rows.begin, rows.size()),
          record.y.middleRows(rows.begin, rows.size()), segments_from(record, rows)};
}

Record joined(const std::vector<const Record*>& parts) {
  assert(!parts.empty());
  Index rows = 0;
  for (const Record* part : parts) rows += part->rows();
  const Record& first = *parts.front();
  Record result{first.period_s, Matrix(rows, first.u.cols()), Matrix(rows, first.y.cols()), {}};
  Index at = 0;
  for (const Record* part : parts) {
    result.u.middleRows(at, part->rows()) = part->u;
    result.y.middleRows(at, part->rows()) = part->y;
    for (const Segment& segment : part->segments) {
      if (!result.segments.empty() &&
          result.segments.back().first_tick + result.segments.back().size() == segment.first_tick)
        result.segments.back().end += segment.size();
      else
        result.segments.push_back({at + segment.begin, at + segment.end, segment.first_tick});
    }
    at += part->rows();
  }
  return result;
}

Index first_row_at(const Record& record, std::int64_t tick) {
  const auto segment =
      std::partition_point(record.segments.begin(), record.segments.end(),
                           [tick](const Segment& s) { return s.first_tick + s.size() <= tick; });
  if (segment == record.segments.end()) return record.rows();
  return tick <= segment->first_tick ? segment->begin
                                     : segment->begin + (tick - segment->first_tick);
}

}  // namespace reident::identification
