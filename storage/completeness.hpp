// How many samples came, and how many are missing, in each stretch of time.
//
// Missing samples are those that would stand in the gaps of a series (sample_gaps.hpp), one for
// each step of the chunks beside the gap: the larger step of the two. A gap counts in the bin in
// which it begins, its missing samples in the bins in which they would stand. A series is expected
// from its first sample on.
//
// Counts come from the rows of the chunks; times are decoded where a chunk crosses a bin's border,
// and where recent samples lie over it.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/holdings.hpp"

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

/// Counts of the series' samples in each bin. Where its last sample is followed by none up to
/// `until`, that is a gap too, if it is long enough for one. Throws Error (corrupt) where samples
/// cannot be decoded.
std::vector<BinCounts> completeness(const Database& database, const SeriesInfo& series,
                                    const TimeBins& bins, Time until);

}  // namespace reident::storage
