#include "identification/simulation/square_changes.hpp"

#include <algorithm>
#include <numeric>

namespace reident::identification {

SquareChanges square_changes(const Matrix& signals, const std::vector<RowRange>& segments) {
  constexpr double median_of_a_normal = 0.4549;  // of chi-squared with one degree of freedom
  const Index m = signals.cols();
  SquareChanges result{Vector::Zero(m), Vector::Zero(m)};
  std::vector<double> squares;
  for (Index j = 0; j < m; ++j) {
    squares.clear();
    for (const RowRange& segment : segments)
      for (Index k = segment.begin + 1; k < segment.end; ++k) {
        const double change = signals(k, j) - signals(k - 1, j);
        squares.push_back(change * change);
      }
    if (squares.empty()) continue;
    result.mean(j) =
        std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size());
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    result.usual(j) = *middle / median_of_a_normal;
  }
  return result;
}

SquareChanges square_changes(const Record& record) {
  return square_changes(record.u, ranges_from(record, record.all()));
}

}  // namespace reident::identification
