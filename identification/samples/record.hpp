// Samples on a uniform grid of time, holes left out.
//
// Row r of `u` (N x m) and `y` (N x p) holds the inputs and outputs at one tick of the grid. Rows
// are ascending in time; a segment is a stretch of rows whose ticks follow each other without a
// hole, and the next segment starts after one. Only rows with every channel valid are kept, so
// memory follows the samples, not the length of the gaps.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Half-open range of rows [begin, end).
struct RowRange {
  Index begin = 0;
  Index end = 0;
  Index size() const { return end - begin; }
  bool operator==(const RowRange&) const = default;
};

/// Half-open range of ticks [begin, end).
struct TickRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  bool operator==(const TickRange&) const = default;
};

/// Rows [begin, end) stand at the ticks first_tick, first_tick + 1, ...
struct Segment {
  Index begin = 0;
  Index end = 0;
  std::int64_t first_tick = 0;
  Index size() const { return end - begin; }
  bool operator==(const Segment&) const = default;
};

struct Record {
  double period_s = 1;
  Matrix u;
  Matrix y;
  std::vector<Segment> segments;  // ascending, disjoint; together they cover all rows

  Index rows() const { return y.rows(); }
  RowRange all() const { return {0, rows()}; }
};

/// A record of one segment that starts at tick 0.
Record contiguous_record(double period_s, Matrix u, Matrix y);

/// The parts of the segments that lie in `rows`, ascending.
std::vector<Segment> segments_within(const std::vector<Segment>& segments, RowRange rows);
std::vector<Segment> segments_within(const Record& record, RowRange rows);

/// The same, their rows counted from rows.begin.
std::vector<Segment> segments_from(const Record& record, RowRange rows);

/// The rows at `ticks`, as a record of their own.
Record rows_at(const Record& record, TickRange ticks);

/// One record of the rows of all, which are ascending in time and of the same channels; stretches
/// that follow each other without a hole become one segment.
Record joined(const std::vector<const Record*>& parts);

/// First row whose tick is not before `tick` (rows() when there is none).
Index first_row_at(const Record& record, std::int64_t tick);

}  // namespace reident::identification
