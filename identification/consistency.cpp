#include "identification/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace reident::identification {
namespace {

constexpr Index level_rows = 121;
constexpr Index shift_rows = 1201;
/// Left out on both sides: where the median turns is known to a part of its stretch.
constexpr Index margin_rows = 60;
/// Of the tolerance: a shift that counts.
constexpr double shift_share = 0.5;

double median(std::vector<double> sorted) {
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

/// The rows whose surrounding stretch of `length` rows has its median more than `limit` away from
/// `centre`. At either end the stretch is the first or the last.
std::vector<RowRange> stretches_beyond(const Vector& r, double centre, double limit, Index length) {
  const Index rows = r.size();
  const auto side = [&](Index row) {
    const double away = r(row) - centre;
    return away > limit ? 1 : away < -limit ? -1 : 0;
  };
  Index above = 0, below = 0;
  const auto count = [&](Index row, Index one) {
    const int at = side(row);
    if (at > 0) above += one;
    if (at < 0) below += one;
  };
  for (Index row = 0; row < length; ++row) count(row, 1);
  std::vector<RowRange> found;
  const auto add = [&found](RowRange range) {
    if (!found.empty() && found.back().end >= range.begin)
      found.back().end = range.end;
    else
      found.push_back(range);
  };
  const Index half = length / 2;
  for (Index begin = 0; begin + length <= rows; ++begin) {
    const Index centre_row = begin + half;
    if (2 * std::max(above, below) > length)
      add({begin == 0 ? 0 : centre_row, begin + length == rows ? rows : centre_row + 1});
    if (begin + length == rows) break;
    count(begin, -1);
    count(begin + length, 1);
  }
  return found;
}

std::int64_t tick_of(const Record& record, Index row) {
  const auto segment = std::partition_point(record.segments.begin(), record.segments.end(),
                                            [row](const Segment& one) { return one.end <= row; });
  return segment->first_tick + (row - segment->begin);
}

}  // namespace

std::vector<Inconsistency> inconsistencies(const Record& residual, double tolerance) {
  eigen_assert(residual.y.cols() == 1 && tolerance > 0);
  const Vector r = residual.y.col(0);
  std::vector<Inconsistency> found;
  const auto take = [&](double centre, double limit, Index length, bool is_shift) {
    if (r.size() < length) return;
    for (const RowRange& rows : stretches_beyond(r, centre, limit, length)) {
      const RowRange wide{std::max<Index>(0, rows.begin - margin_rows),
                          std::min(r.size(), rows.end + margin_rows)};
      found.push_back({{tick_of(residual, wide.begin), tick_of(residual, wide.end - 1) + 1},
                       median({r.begin() + rows.begin, r.begin() + rows.end}),
                       is_shift});
    }
  };
  take(0, tolerance, level_rows, false);
  std::vector<double> tolerable;
  std::copy_if(r.begin(), r.end(), std::back_inserter(tolerable),
               [tolerance](double value) { return std::abs(value) <= tolerance; });
  if (static_cast<Index>(tolerable.size()) >= shift_rows)
    take(median(std::move(tolerable)), shift_share * tolerance, shift_rows, true);
  std::stable_sort(found.begin(), found.end(), [](const Inconsistency& a, const Inconsistency& b) {
    return a.ticks.begin < b.ticks.begin;
  });
  return found;
}

}  // namespace reident::identification
