#include "service/cli/output/trace.hpp"

#include <algorithm>
#include <cmath>

namespace reident::cli {
namespace {

/// The points of one column.
struct Column {
  double number = 0;
  Point least, greatest;  // by their y in pixels
  bool least_first = true;

  void add(Point point) {
    if (point.y < least.y) {
      least = point;
      least_first = false;
    }
    if (point.y > greatest.y) {
      greatest = point;
      least_first = true;
    }
  }
  void append_to(std::vector<Point>& line) const {
    line.push_back(least_first ? least : greatest);
    if (least.y != greatest.y) line.push_back(least_first ? greatest : least);
  }
};

}  // namespace

std::vector<std::vector<Point>> trace(const std::vector<TraceSegment>& segments,
                                      const Scale& x_scale, const Scale& y_scale, double column) {
  std::vector<std::vector<Point>> lines;
  double last_x = -2 * column;
  for (const TraceSegment& segment : segments) {
    if (segment.x.empty()) continue;
    if (lines.empty() || x_scale(segment.x.front()) - last_x > column) lines.emplace_back();
    std::vector<Point>& line = lines.back();
    Column current{-1, {}, {}};
    for (std::size_t i = 0; i < segment.x.size(); ++i) {
      const Point point{x_scale(segment.x[i]),
                        y_scale(std::clamp(segment.y[i], y_scale.low, y_scale.high))};
      const double number = std::floor(point.x / column);
      if (i == 0 || number != current.number) {
        if (i > 0) current.append_to(line);
        current = {number, point, point};
      } else {
        current.add(point);
      }
    }
    current.append_to(line);
    last_x = x_scale(segment.x.back());
    if (line.size() == 1) line.push_back({line.front().x + 1, line.front().y});  // to be seen
  }
  return lines;
}

}  // namespace reident::cli
