#include "identification/statistics/sensor_noise.hpp"

#include "identification/simulation/square_changes.hpp"

namespace reident::identification {

Vector noise_squares(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments) {
  Vector squares(y.cols());
  for (Index q = 0; q < y.cols(); ++q) {
    const Vector errors = y.col(q) - run.col(q);
    std::vector<double> fresh;  // errors where a sample is new
    std::vector<RowRange> of_fresh;
    Index pairs = 0, changes = 0;
    for (const RowRange& segment : segments) {
      const auto first = static_cast<Index>(fresh.size());
      for (Index k = segment.begin + 1; k < segment.end; ++k) {
        ++pairs;
        if (y(k, q) == y(k - 1, q)) continue;
        ++changes;
        fresh.push_back(errors(k));
      }
      of_fresh.push_back({first, static_cast<Index>(fresh.size())});
    }
    squares(q) =
        2 * changes < pairs
            ? square_changes(Eigen::Map<const Vector>(fresh.data(), std::ssize(fresh)), of_fresh)
                  .usual(0)
            : square_changes(errors, segments).usual(0);
  }
  return squares / 2;
}

}  // namespace reident::identification
