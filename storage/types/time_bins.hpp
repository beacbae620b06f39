// A range of time cut into bins, and the counts of samples in each: for tables by the day or by
// the hour, whose lines begin at whole days and hours of UTC.
#pragma once

#include <cstddef>
#include <cstdint>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Neighbouring ranges of time, each but the outer ones `length` long and beginning at a
/// multiple of it since 1970. The outer ones end where the range does, so that every time of the
/// range is in one bin.
class TimeBins {
 public:
  /// Cuts `range` into bins of `length` [ns], one for each multiple of the length that it meets.
  /// range.begin < range.end, 0 < length.
  TimeBins(TimeRange range, Time length);
  /// How many bins there are, at least 1.
  std::size_t count() const { return count_; }
  TimeRange range() const { return range_; }
  Time length() const { return length_; }
  /// The half-open range of a bin; bin < count().
  TimeRange at(std::size_t bin) const;
  /// The bin that holds `time`, which is in the range.
  std::size_t of(Time time) const;

 private:
  TimeRange range_;
  Time length_;
  /// Begin of the first bin, as a multiple of the length.
  std::int64_t first_;
  std::size_t count_;
};

/// How complete one bin is: of one series, or of several added up.
struct BinCounts {
  /// Samples that are there, and those that would stand in gaps (completeness.hpp).
  std::uint64_t came = 0;
  std::uint64_t missing = 0;
  /// Gaps that begin in the bin, and the length of the longest of them [ns].
  std::uint64_t gaps = 0;
  Time longest_gap = 0;

  /// Adds the counts of another series or bin; of the longest gaps the longer one stays.
  BinCounts& operator+=(const BinCounts& other);
  /// Samples that the bin would have without its gaps.
  std::uint64_t expected() const { return came + missing; }
};

}  // namespace reident::storage
