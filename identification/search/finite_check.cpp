#include "identification/search/finite_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace reident::identification {

bool all_finite(const RangeSums& sums) {
  return std::all_of(sums.segments.begin(), sums.segments.end(), [](const SegmentSums& segment) {
    return segment.sum().allFinite() && segment.products().allFinite();
  });
}

std::optional<Verdict> non_finite_values(const Record& record, RowRange rows,
                                         const IdentifyOptions& options) {
  constexpr double largest_square_root = 1e150;
  const auto look = [rows](const Matrix& channels, const char* kind,
                           const std::vector<std::string>& names) -> std::optional<Verdict> {
    for (Index c = 0; c < channels.cols(); ++c)
      for (Index r = rows.begin; r < rows.end; ++r)
        if (!std::isfinite(channels(r, c)))
          return Verdict{VerdictCode::non_finite,
                         channel_name(kind, c, names) + " is not a finite number in row " +
                             std::to_string(r) +
                             "; mark such samples as invalid or leave the row out"};
        else if (std::abs(channels(r, c)) > largest_square_root)
          return Verdict{VerdictCode::non_finite,
                         channel_name(kind, c, names) + " is beyond 1e150 in row " +
                             std::to_string(r) +
                             ", which no sum of squares can hold; give it in another unit"};
    return std::nullopt;
  };
  if (auto verdict = look(record.u, "input", options.input_names)) return verdict;
  return look(record.y, "output", options.output_names);
}

}  // namespace reident::identification
