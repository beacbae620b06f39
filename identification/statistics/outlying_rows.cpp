#include "identification/statistics/outlying_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace reident::identification {
namespace {

constexpr double deviations = 8;
constexpr double deviation_of_median = 1.4826;  // of normal distances
constexpr double most_rows = 0.1;

}  // namespace

std::vector<Index> outlying_rows(const Vector& values, const std::vector<RowRange>& segments,
                                 double least_square_share) {
  std::vector<std::pair<Index, double>> distances;
  for (const RowRange& segment : segments)
    for (Index row = segment.begin + 2; row + 2 < segment.end; ++row) {
      std::array<double, 5> around;
      std::copy_n(values.begin() + row - 2, around.size(), around.begin());
      std::nth_element(around.begin(), around.begin() + 2, around.end());
      distances.emplace_back(row, std::abs(values(row) - around[2]));
    }
  if (distances.empty()) return {};
  std::vector<double> sorted;
  // One of five rows is the median itself.
  for (const auto& [row, distance] : distances)
    if (distance > 0) sorted.push_back(distance);
  if (sorted.empty()) return {};
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const bool most_are_the_median = double(sorted.size()) <= most_rows * double(distances.size());
  const double limit = most_are_the_median ? 0 : deviations * deviation_of_median * *middle;
  std::vector<Index> rows;
  double beyond = 0, all = 0;
  for (const auto& [row, distance] : distances) {
    all += distance * distance;
    if (!(distance > limit)) continue;
    beyond += distance * distance;
    rows.push_back(row);
  }
  const bool are_few = double(rows.size()) <= most_rows * double(distances.size());
  return are_few && beyond >= least_square_share * all ? rows : std::vector<Index>();
}

}  // namespace reident::identification
