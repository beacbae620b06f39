// Samples on a uniform grid of time, holes left out. Nothing here throws.
//
// Row r of `u` (N x m) and `y` (N x p) holds the inputs and outputs at one tick of the grid. Rows
// are ascending in time; a segment is a range of rows whose ticks follow each other without a
// hole, and the next segment starts after one. Only rows with every channel valid are kept, so
// memory follows the samples, not the length of the gaps.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Half-open range of rows [begin, end), counted from the record's first.
struct RowRange {
  Index begin = 0;
  Index end = 0;
  Index size() const { return end - begin; }
  bool operator==(const RowRange&) const = default;
};

/// Half-open range of ticks [begin, end); tick k stands at the time k * period.
struct TickRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  bool operator==(const TickRange&) const = default;
};

/// Rows [begin, end) without a hole: each is a tick behind the one before.
struct Segment {
  Index begin = 0;
  Index end = 0;
  std::int64_t first_tick = 0;  // of the row `begin`
  Index size() const { return end - begin; }
  std::int64_t tick_of(Index row) const { return first_tick + (row - begin); }
  std::int64_t end_tick() const { return tick_of(end); }
  bool operator==(const Segment&) const = default;
};

/// The samples of a range of time.
struct Record {
  double period_s = 1;            // from one tick to the next [s], positive
  Matrix u;                       // N x m, in the units of the inputs
  Matrix y;                       // N x p, in the units of the outputs
  std::vector<Segment> segments;  // ascending, disjoint; together they cover all rows

  /// Returns N.
  Index rows() const { return y.rows(); }
  /// Returns the range of all rows.
  RowRange all() const { return {0, rows()}; }
};

/// Returns a record of one segment that starts at tick 0. Requires as many rows in `u` as in `y`.
Record contiguous_record(double period_s, Matrix u, Matrix y);

/// Returns the parts of the segments that are in `rows`, ascending, with their own ticks.
std::vector<Segment> segments_within(const std::vector<Segment>& segments, RowRange rows);
std::vector<Segment> segments_within(const Record& record, RowRange rows);

/// Returns segments_within() with the rows counted from rows.begin.
std::vector<Segment> segments_from(const Record& record, RowRange rows);

/// Returns the ranges of segments_from().
std::vector<RowRange> ranges_from(const Record& record, RowRange rows);

/// Returns the rows at `ticks` as a record of their own, with their ticks; empty where there are
/// none.
Record rows_at(const Record& record, TickRange ticks);

/// Returns the first row at or behind the tick; rows() where there is none. The cost is logarithmic
/// in the segments.
Index first_row_at(const Record& record, std::int64_t tick);

/// Returns what the digits of a channel resolve: the least difference of two of its values, 0 where
/// all are one.
double resolution(Vector channel);

/// Returns the tick of the row; of rows(), the one behind the last row's. Requires that the record
/// has rows, and the cost is that of first_row_at().
std::int64_t tick_of_row(const Record& record, Index row);

}  // namespace reident::identification
