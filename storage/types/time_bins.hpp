// A stretch of time cut into bins, and the counts of samples in each.
#pragma once

#include <cstddef>
#include <cstdint>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Neighbouring stretches of time, each but the outer ones `length` long and beginning at a
/// multiple of it.
class TimeBins {
 public:
  /// range.begin < range.end, 0 < length.
  TimeBins(TimeRange range, Time length);
  std::size_t count() const { return count_; }
  TimeRange range() const { return range_; }
  Time length() const { return length_; }
  TimeRange at(std::size_t bin) const;
  /// Of a time in the range.
  std::size_t of(Time time) const;

 private:
  TimeRange range_;
  Time length_;
  std::int64_t first_;  // begin of the first bin, as a multiple of the length
  std::size_t count_;
};

struct BinCounts {
  std::uint64_t came = 0;
  std::uint64_t missing = 0;
  std::uint64_t gaps = 0;  // that begin in the bin
  Time longest_gap = 0;    // of those [ns]

  BinCounts& operator+=(const BinCounts& other);
  std::uint64_t expected() const { return came + missing; }
};

}  // namespace reident::storage
