#include "identification/screening/relation_check.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr Index level_rows = 121;
constexpr Index shift_rows = 1201;
/// Left out on both sides: where the median turns is known to a part of its range.
constexpr Index margin_rows = 60;
/// A shift counts from this share of the tolerance on.
constexpr double shift_share = 0.5;

double median(const std::vector<double>& values) {
  return nth_smallest(values, values.size() / 2);
}

/// The rows of whose surrounding range of `length` rows more than half are more than `limit` away
/// from `centre`: on one side of it, or on both together. At either end the range is the first
/// or the last.
std::vector<RowRange> ranges_beyond(const Vector& r, double centre, double limit, Index length,
                                    bool on_one_side) {
  const Index rows = r.size();
  if (2 * ((r.array() - centre).abs() > limit).count() <= length) return {};
  Index above = 0, below = 0;
  const auto count = [&](Index row, Index one) {
    const double away = r(row) - centre;
    if (away > limit) above += one;
    if (away < -limit) below += one;
  };
  for (Index row = 0; row < length; ++row) count(row, 1);
  std::vector<RowRange> found;
  for (Index begin = 0;; ++begin) {
    if (2 * (on_one_side ? std::max(above, below) : above + below) > length) {
      const RowRange here{begin == 0 ? 0 : begin + length / 2,
                          begin + length == rows ? rows : begin + length / 2 + 1};
      if (!found.empty() && found.back().end >= here.begin)
        found.back().end = here.end;
      else
        found.push_back(here);
    }
    if (begin + length == rows) return found;
    count(begin, -1);
    count(begin + length, 1);
  }
}

double residual_of(const Vector& r, RowRange rows, bool is_shift) {
  std::vector<double> values(r.begin() + rows.begin, r.begin() + rows.end);
  const double middle = median(values);
  if (is_shift) return middle;
  for (double& value : values) value = std::abs(value);
  return std::copysign(median(values), middle);
}

std::int64_t tick_of(const Record& record, Index row) {
  const auto segment = std::partition_point(record.segments.begin(), record.segments.end(),
                                            [row](const Segment& one) { return one.end <= row; });
  return segment->first_tick + (row - segment->begin);
}

}  // namespace

std::vector<Inconsistency> inconsistencies(const Record& residual, double tolerance) {
  assert(residual.y.cols() == 1 && tolerance > 0);
  const Vector r = residual.y.col(0);
  std::vector<Inconsistency> found;
  const auto take = [&](double centre, double limit, Index length, bool is_shift) {
    if (r.size() < length) return;
    for (const RowRange& rows : ranges_beyond(r, centre, limit, length, is_shift)) {
      const RowRange wide{std::max<Index>(0, rows.begin - margin_rows),
                          std::min(r.size(), rows.end + margin_rows)};
      found.push_back({{tick_of(residual, wide.begin), tick_of(residual, wide.end - 1) + 1},
                       residual_of(r, rows, is_shift),
                       is_shift});
    }
  };
  take(0, tolerance, level_rows, false);
  const double limit = shift_share * tolerance;
  // With most rows within half the limit their median is too, and nothing else is beyond the limit
  // of it.
  if (2 * (r.array().abs() > limit / 2).count() > shift_rows) {
    std::vector<double> tolerable;
    std::copy_if(r.begin(), r.end(), std::back_inserter(tolerable),
                 [tolerance](double value) { return std::abs(value) <= tolerance; });
    if (static_cast<Index>(tolerable.size()) >= shift_rows)
      take(median(tolerable), limit, shift_rows, true);
  }
  std::stable_sort(found.begin(), found.end(), [](const Inconsistency& a, const Inconsistency& b) {
    return a.ticks.begin < b.ticks.begin;
  });
  return found;
}

}  // namespace reident::identification
