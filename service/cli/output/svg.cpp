#include "service/cli/output/svg.hpp"

#include <iterator>

#include <fmt/format.h>

namespace reident::cli {
namespace {

/// A tenth of a pixel, without digits that say nothing.
std::string length(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

}  // namespace

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) escaped += c;
    }
  }
  return escaped;
}

Svg::Svg(double width, double height, std::string_view title, std::string_view style)
    : text_(fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
                        "viewBox=\"0 0 {0} {1}\" role=\"img\">\n"
                        "<title>{2}</title>\n<style>\n{3}</style>\n",
                        length(width), length(height), xml_escaped(title), style)) {}

void Svg::rectangle(const Box& box, std::string_view css_class) {
  text_ +=
      fmt::format("<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", css_class,
                  length(box.x), length(box.y), length(box.width), length(box.height));
}

void Svg::line(Point from, Point to, std::string_view css_class) {
  text_ += fmt::format("<line class=\"{}\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>\n", css_class,
                       length(from.x), length(from.y), length(to.x), length(to.y));
}

void Svg::circle(Point centre, double radius, std::string_view css_class) {
  text_ += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", css_class,
                       length(centre.x), length(centre.y), length(radius));
}

void Svg::cross(Point centre, double radius, std::string_view css_class) {
  const double r = radius;
  text_ += fmt::format("<path class=\"{}\" d=\"M{} {}l{} {}m0 {}l{} {}\"/>\n", css_class,
                       length(centre.x - r), length(centre.y - r), length(2 * r), length(2 * r),
                       length(-2 * r), length(-2 * r), length(2 * r));
}

void Svg::polyline(std::span<const Point> points, std::string_view css_class) {
  text_ += fmt::format("<polyline class=\"{}\" points=\"", css_class);
  for (const Point& point : points)
    fmt::format_to(std::back_inserter(text_), "{},{} ", length(point.x), length(point.y));
  text_ += "\"/>\n";
}

void Svg::text(Point at, std::string_view words, std::string_view css_class,
               std::string_view anchor) {
  text_ += fmt::format("<text class=\"{}\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n",
                       css_class, length(at.x), length(at.y), anchor, xml_escaped(words));
}

void Svg::turned_text(Point at, std::string_view words, std::string_view css_class) {
  text_ += fmt::format(
      "<text class=\"{0}\" transform=\"translate({1} {2}) rotate(-90)\" "
      "text-anchor=\"middle\">{3}</text>\n",
      css_class, length(at.x), length(at.y), xml_escaped(words));
}

void Svg::begin_group(std::string_view id) {
  text_ += fmt::format("<g id=\"{}\">\n", xml_escaped(id));
}

void Svg::end_group() {
  text_ += "</g>\n";
}

std::string Svg::finish() && {
  return std::move(text_) + "</svg>\n";
}

}  // namespace reident::cli
