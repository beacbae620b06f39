#include "tests/bench/paper/paper_picture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/svg.hpp"
#include "service/cli/output/trace.hpp"

namespace reident::bench {
namespace {

using cli::Box;
using cli::Scale;
using cli::Svg;
using identification::Index;
using identification::Vector;

constexpr double width = 1000, left = 84, right = 980, top = 76;
constexpr double run_height = 240, error_height = 90, gap = 34, foot = 44;

constexpr std::string_view style = R"(text{font:12px sans-serif;fill:#333}
.title{font-size:18px;font-weight:bold;fill:#111}
.small{font-size:11px;fill:#555}
.page{fill:#fff}
.frame{fill:none;stroke:#999;stroke-width:1}
.grid{stroke:#000;stroke-opacity:.1;stroke-width:1}
.zero{stroke:#777;stroke-width:1}
.measured{fill:none;stroke:#222;stroke-width:1.4}
.simulator{fill:none;stroke:#999;stroke-width:1.4}
.identified{fill:none;stroke:#d1480a;stroke-width:1.2;stroke-opacity:.85}
.following{fill:none;stroke:#1c8a4a;stroke-width:1.2}
polyline{stroke-linejoin:round;stroke-linecap:round}
)";

void draw_frame(Svg& svg, const PaperPicture& picture, const Box& box, const Scale& y, int marks,
                bool labelled) {
  const Scale x{0, double(picture.range.end - picture.range.begin) * 1e-9, left, right};
  for (const cli::Tick& tick : cli::time_ticks(picture.range, 8)) {
    svg.line({x(tick.value), box.y}, {x(tick.value), box.bottom()}, "grid");
    if (labelled) svg.text({x(tick.value), box.bottom() + 16}, tick.label, "small", "middle");
  }
  for (const cli::Tick& tick : cli::ticks_of(y, marks)) {
    svg.line({left, y(tick.value)}, {right, y(tick.value)}, "grid");
    svg.text({left - 6, y(tick.value) + 4}, tick.label, "small", "end");
  }
  svg.rectangle(box, "frame");
}

void draw_line(Svg& svg, const PaperPicture& picture, const Vector& values, const Scale& y,
               std::string_view css_class) {
  std::vector<cli::TraceSegment> segments(1);
  for (Index row = 0; row < values.size(); ++row)
    if (std::isfinite(values(row))) {
      segments[0].x.push_back(picture.x(row));
      segments[0].y.push_back(values(row));
    }
  const Scale x{0, double(picture.range.end - picture.range.begin) * 1e-9, left, right};
  for (const auto& line : cli::trace(segments, x, y, 1)) svg.polyline(line, css_class);
}

Vector without_gaps(const Vector& values) {
  return values.array().isFinite().select(values, 0);
}

double draw_runs(Svg& svg, const PaperPicture& picture) {
  const Box box{left, top, right - left, run_height};
  double low = picture.y.minCoeff(), high = picture.y.maxCoeff();
  const double span = high - low;
  for (const PictureRun& run : picture.runs) {
    const Vector y = run.y.array().isFinite().select(run.y, picture.y);
    low = std::min(low, std::max(y.minCoeff(), low - span));
    high = std::max(high, std::min(y.maxCoeff(), high + span));
  }
  const Scale y = cli::scale_around(low, high, box.bottom(), box.y);
  draw_frame(svg, picture, box, y, 6, false);
  for (const PictureRun& run : picture.runs)
    if (run.style == "simulator") draw_line(svg, picture, run.y, y, run.style);
  draw_line(svg, picture, picture.y, y, "measured");
  for (const PictureRun& run : picture.runs)
    if (run.style != "simulator") draw_line(svg, picture, run.y, y, run.style);
  svg.turned_text({22, box.y + box.height / 2},
                  fmt::format("{} [{}]", picture.output, picture.unit), "small");
  return box.bottom();
}

double draw_errors(Svg& svg, const PaperPicture& picture, double y) {
  for (const PictureRun& run : picture.runs) {
    const Box box{left, y + gap, right - left, error_height};
    const Vector error = picture.y - run.y;
    const double most = std::max(1e-12, without_gaps(error).cwiseAbs().maxCoeff());
    const Scale scale = cli::scale_around(-most, most, box.bottom(), box.y);
    draw_frame(svg, picture, box, scale, 4, &run == &picture.runs.back());
    svg.line({left, scale(0)}, {right, scale(0)}, "zero");
    draw_line(svg, picture, error, scale, run.style);
    svg.turned_text({22, box.y + box.height / 2}, fmt::format("error [{}]", picture.unit), "small");
    svg.text({left, box.y - 7},
             fmt::format("error of {}: MRSE {:.3g} % over all rows that validate", run.name,
                         run.mrse_percent),
             "small");
    y = box.bottom();
  }
  svg.text({right, y + 34}, "UTC", "small", "end");
  return y;
}

}  // namespace

std::string svg_of(const PaperPicture& picture) {
  const double height =
      top + run_height + double(picture.runs.size()) * (gap + error_height) + foot;
  Svg svg(width, height, picture.title, style);
  svg.rectangle({0, 0, width, height}, "page");
  svg.text({20, 30}, picture.title, "title");
  double x = 20;
  const auto name = [&](std::string_view css_class, std::string_view words) {
    svg.line({x, 54}, {x + 24, 54}, css_class);
    svg.text({x + 30, 58}, words, "small");
    x += 48 + 5.8 * double(words.size());
  };
  name("measured", "measured");
  for (const PictureRun& run : picture.runs) name(run.style, run.name);
  draw_errors(svg, picture, draw_runs(svg, picture));
  return std::move(svg).finish();
}

}  // namespace reident::bench
