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
/// or the last. Requires so many rows.
std::vector<RowRange> ranges_beyond(const Vector& r, double centre, double limit, Index length,
                                    bool on_one_side) {
  const Index rows = r.size();
  if (2 * ((r.array() - centre).abs() > limit).count() <= length) return {};
  Eigen::Matrix<Index, Eigen::Dynamic, 1> above(rows + 1), below(rows + 1);  // before each row
  above[0] = below[0] = 0;
  for (Index row = 0; row < rows; ++row) {
    const double away = r(row) - centre;
    above[row + 1] = above[row] + (away > limit ? 1 : 0);
    below[row + 1] = below[row] + (away < -limit ? 1 : 0);
  }
  std::vector<RowRange> found;
  for (Index begin = 0; begin + length <= rows;) {
    const Index over = above[begin + length] - above[begin];
    const Index under = below[begin + length] - below[begin];
    const Index beyond = on_one_side ? std::max(over, under) : over + under;
    if (2 * beyond <= length) {
      begin += length / 2 + 1 - beyond;  // each row changes it by one at most
      continue;
    }
    const RowRange here{begin == 0 ? 0 : begin + length / 2,
                        begin + length == rows ? rows : begin + length / 2 + 1};
    if (!found.empty() && found.back().end >= here.begin)
      found.back().end = here.end;
    else
      found.push_back(here);
    ++begin;
  }
  return found;
}

double residual_of(const Vector& r, RowRange rows, bool is_shift) {
  std::vector<double> values(r.begin() + rows.begin, r.begin() + rows.end);
  const double middle = median(values);
  if (is_shift) return middle;
  for (double& value : values) value = std::abs(value);
  return std::copysign(median(values), middle);
}

/// Whether rows may be beyond the limit of the median. With most rows within half the limit the
/// median is too.
bool may_shift(const Vector& r, double limit) {
  const bool is_median_small = 2 * (r.array().abs() <= limit / 2).count() > r.size();
  return !is_median_small || !ranges_beyond(r, 0, limit / 2, shift_rows, true).empty();
}

}  // namespace

std::vector<Inconsistency> inconsistencies(const Record& residual, double tolerance) {
  assert(residual.y.cols() == 1 && tolerance > 0);
  const Vector r = residual.y.col(0);
  std::vector<Inconsistency> found;
  const auto take = [&](double centre, double limit, Index length, bool is_shift) {
    for (const RowRange& rows : ranges_beyond(r, centre, limit, length, is_shift)) {
      const RowRange wide{std::max<Index>(0, rows.begin - margin_rows),
                          std::min(r.size(), rows.end + margin_rows)};
      found.push_back({{tick_of_row(residual, wide.begin), tick_of_row(residual, wide.end - 1) + 1},
                       residual_of(r, rows, is_shift),
                       is_shift});
    }
  };
  if (r.size() >= level_rows) take(0, tolerance, level_rows, false);
  if (r.size() >= shift_rows && may_shift(r, shift_share * tolerance)) {
    std::vector<double> tolerable;
    std::copy_if(r.begin(), r.end(), std::back_inserter(tolerable),
                 [tolerance](double value) { return std::abs(value) <= tolerance; });
    if (static_cast<Index>(tolerable.size()) >= shift_rows)
      take(median(tolerable), shift_share * tolerance, shift_rows, true);
  }
  std::stable_sort(found.begin(), found.end(), [](const Inconsistency& a, const Inconsistency& b) {
    return a.ticks.begin < b.ticks.begin;
  });
  return found;
}

}  // namespace reident::identification
