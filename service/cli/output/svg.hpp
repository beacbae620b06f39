// A picture as SVG text, written from back to front. Lengths are in pixels, y points down.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace reident::cli {

struct Point {
  double x = 0;
  double y = 0;
};

struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

/// Each element names a class of the style sheet, which says how it looks.
class Svg {
 public:
  /// `style` is the style sheet; `title` is what a screen reader says.
  Svg(double width, double height, std::string_view title, std::string_view style);

  void rectangle(const Box& box, std::string_view css_class);
  void line(Point from, Point to, std::string_view css_class);
  void circle(Point centre, double radius, std::string_view css_class);
  /// A cross of two strokes.
  void cross(Point centre, double radius, std::string_view css_class);
  void polyline(std::span<const Point> points, std::string_view css_class);
  /// `anchor` is "start", "middle" or "end".
  void text(Point at, std::string_view words, std::string_view css_class,
            std::string_view anchor = "start");
  /// Turned by 90 degrees against the clock, centred on `at`.
  void turned_text(Point at, std::string_view words, std::string_view css_class);
  /// What is drawn until end_group() belongs together under `id`.
  void begin_group(std::string_view id);
  void end_group();

  /// The whole document; call once, at the end.
  std::string finish() &&;

 private:
  std::string text_;
};

/// With &, <, >, and quotes as entities, and control characters, which XML does not have, left out.
std::string xml_escaped(std::string_view text);

}  // namespace reident::cli
