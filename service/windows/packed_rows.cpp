#include "service/windows/packed_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace reident {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::Segment;
using identification::TickRange;

namespace {

constexpr std::size_t few = 256;  // as many as a byte tells apart

/// The different values of a channel in the order in which they come, found by their bits.
class DifferentValues {
 public:
  explicit DifferentValues(std::vector<double>& values) : values_(values), begin_(values.size()) {}

  /// Returns the place of the value; `few` where it would be one more than that many.
  std::size_t place_of(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;
    std::size_t slot = (bits * golden) >> (64 - std::bit_width(slots - 1));
    for (; slots_[slot] != 0; slot = (slot + 1) % slots)
      if (std::bit_cast<std::uint64_t>(values_[begin_ + slots_[slot] - 1]) == bits)
        return slots_[slot] - 1U;
    const std::size_t place = values_.size() - begin_;
    if (place == few) return few;
    values_.push_back(value);
    slots_[slot] = static_cast<std::uint16_t>(place + 1);
    return place;
  }

 private:
  static constexpr std::size_t slots = 4 * few;
  std::vector<double>& values_;
  std::size_t begin_;
  std::array<std::uint16_t, slots> slots_{};  // place + 1; 0: free
};

}  // namespace

void add_segment(std::vector<Segment>& segments, Segment next) {
  if (!segments.empty() && segments.back().end_tick() == next.first_tick)
    segments.back().end = next.end;
  else
    segments.push_back(next);
}

PackedRows::PackedRows(const Record& record, TickRange ticks)
    : period_s_(record.period_s), inputs_(record.u.cols()) {
  const RowRange rows{first_row_at(record, ticks.begin), first_row_at(record, ticks.end)};
  rows_ = rows.size();
  segments_ = segments_from(record, rows);
  pack(record.u, rows);
  pack(record.y, rows);
  values_.shrink_to_fit();
  places_.shrink_to_fit();
}

void PackedRows::pack(const Matrix& columns, RowRange rows) {
  for (Index c = 0; c < columns.cols(); ++c) {
    const std::size_t values = values_.size(), places = places_.size();
    DifferentValues different(values_);
    const double* column = columns.col(c).data();
    for (Index row = rows.begin; row < rows.end; ++row) {
      const std::size_t place = different.place_of(column[row]);
      if (place == few) {
        values_.resize(values);
        values_.insert(values_.end(), column + rows.begin, column + rows.end);
        places_.resize(places);
        break;
      }
      places_.push_back(static_cast<std::uint8_t>(place));
    }
    begins_.push_back(static_cast<std::uint32_t>(values_.size()));
  }
}

Record PackedRows::blank(Index rows) const {
  const Index outputs = std::ssize(begins_) - 1 - inputs_;
  return {period_s_, Matrix(rows, inputs_), Matrix(rows, outputs), {}};
}

Index PackedRows::rows_from(std::int64_t tick) const {
  Index rows = 0;
  for (const Segment& segment : segments_)
    rows += std::clamp<Index>(segment.end_tick() - tick, 0, segment.size());
  return rows;
}

void PackedRows::unpack(std::int64_t from_tick, Record& record, Index at) const {
  const Index first = rows_ - rows_from(from_tick);
  const std::uint8_t* places = places_.data();
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    const auto column = static_cast<Index>(c);
    double* out = column < inputs_ ? record.u.col(column).data() + at
                                   : record.y.col(column - inputs_).data() + at;
    const double* values = values_.data() + begins_[c];
    if (begins_[c + 1] - begins_[c] > few) {
      std::copy(values + first, values + rows_, out);
      continue;
    }
    for (Index row = first; row < rows_; ++row) out[row - first] = values[places[row]];
    places += rows_;
  }
  for (const Segment& segment : segments_) {
    const Index begin = std::max(segment.begin, first);
    if (begin < segment.end)
      add_segment(record.segments,
                  {at + begin - first, at + segment.end - first, segment.tick_of(begin)});
  }
}

}  // namespace reident
