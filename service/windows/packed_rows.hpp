// Rows of telemetry kept in little memory, to the last bit.
#pragma once

#include <cstdint>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident {

/// A converter of telemetry gives few different values. A channel that has at most 256 of them in
/// the rows is kept as these and a byte a row; another one as it is.
class PackedRows {
 public:
  /// Takes the rows of the record at `ticks`.
  PackedRows(const identification::Record& record, identification::TickRange ticks);

  /// Returns a record of the same channels with so many rows, which hold nothing yet.
  identification::Record blank(identification::Index rows) const;
  /// Returns how many rows are at this tick or behind it.
  identification::Index rows_from(std::int64_t tick) const;

  /// Writes the rows from this tick on into those of `record` that begin at `at`, and adds their
  /// segments. Requires room, and the same channels.
  void unpack(std::int64_t from_tick, identification::Record& record,
              identification::Index at) const;

 private:
  void pack(const identification::Matrix& columns, identification::RowRange rows);

  double period_s_;
  identification::Index rows_, inputs_;
  std::vector<identification::Segment> segments_;
  std::vector<std::uint32_t> begins_ = {0};  // of each channel in values_, and where the last ends
  std::vector<double> values_;               // the different ones, or those of all rows
  std::vector<std::uint8_t> places_;         // of channels with few: which value, by row
};

/// Adds a segment behind others; one that goes on without a hole becomes part of the last.
void add_segment(std::vector<identification::Segment>& segments, identification::Segment next);

}  // namespace reident
