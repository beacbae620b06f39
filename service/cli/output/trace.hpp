// Long series drawn with few points.
#pragma once

#include <vector>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/svg.hpp"

namespace reident::cli {

/// Consecutive values of one segment; `x` ascends.
struct TraceSegment {
  std::vector<double> x;
  std::vector<double> y;
};

/// Lines through the segments. Each column of `column` pixels keeps the least and the greatest of
/// its values, in their order; segments less than a column apart are drawn as one. Values beyond
/// the scale stay at its edge.
std::vector<std::vector<Point>> trace(const std::vector<TraceSegment>& segments,
                                      const Scale& x_scale, const Scale& y_scale, double column);

}  // namespace reident::cli
