#include "storage/types/time_bins.hpp"

#include <algorithm>
#include <cassert>

namespace reident::storage {
namespace {

std::int64_t floor_divide(Time time, Time length) {
  return time / length - (time % length < 0 ? 1 : 0);
}

}  // namespace

TimeBins::TimeBins(TimeRange range, Time length)
    : range_(range), length_(length), first_(floor_divide(range.begin, length)) {
  assert(range.begin < range.end && length > 0);
  count_ = static_cast<std::size_t>(floor_divide(range.end - 1, length) - first_) + 1;
}

std::size_t TimeBins::of(Time time) const {
  return static_cast<std::size_t>(floor_divide(time, length_) - first_);
}

TimeRange TimeBins::at(std::size_t bin) const {
  const std::int64_t multiple = first_ + static_cast<std::int64_t>(bin);
  return {bin == 0 ? range_.begin : multiple * length_,
          bin + 1 == count_ ? range_.end : (multiple + 1) * length_};
}

BinCounts& BinCounts::operator+=(const BinCounts& other) {
  came += other.came;
  missing += other.missing;
  gaps += other.gaps;
  longest_gap = std::max(longest_gap, other.longest_gap);
  return *this;
}

}  // namespace reident::storage
