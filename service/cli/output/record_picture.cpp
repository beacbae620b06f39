#include "service/cli/output/record_picture.hpp"

#include <algorithm>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/svg.hpp"

namespace reident::cli {
namespace {

constexpr double page_width = 1000, page_height = 400;
constexpr Box panel{84, 104, 896, 240};
constexpr double label_width = 5.8;  // of small text, about

constexpr std::string_view record_style = R"(text{font:12px sans-serif;fill:#333}
.title{font-size:18px;font-weight:bold;fill:#111}
.small{font-size:11px;fill:#555}
.page{fill:#fff}
.frame{fill:none;stroke:#999;stroke-width:1}
.grid{stroke:#000;stroke-opacity:.1;stroke-width:1}
.zero{stroke:#777;stroke-width:1}
.score{fill:#2456b8;fill-opacity:.55}
.mean{fill:none;stroke:#d1480a;stroke-width:1.6}
.lower{fill:none;stroke:#1c8a4a;stroke-width:1.6}
.change{stroke:#b00020;stroke-width:1.4;stroke-dasharray:5 4}
polyline{stroke-linejoin:round;stroke-linecap:round}
)";

void draw_legend(Svg& svg, bool has_change) {
  double x = 20;
  for (const auto& [css_class, label] :
       {std::pair(
            "score",
            "score of a block: 1, it errs nothing compared with the champion; -1, the reverse"),
        std::pair("mean", "mean so far"), std::pair("lower", "its lower confidence bound"),
        std::pair("change", "change of the equipment")}) {
    const std::string_view kind = css_class;
    if (kind == "change" && !has_change) continue;
    if (kind == "score") {
      svg.circle({x + 12, 72}, 3, css_class);
    } else {
      svg.line({x, 72}, {x + 24, 72}, css_class);
    }
    svg.text({x + 30, 76}, label, "small");
    x += 44 + label_width * static_cast<double>(std::string_view(label).size());
  }
}

}  // namespace

std::string record_picture(const RecordPictureData& data) {
  const storage::Time begin = data.blocks.front().begin;
  const storage::Time length =
      data.blocks.size() > 1 ? data.blocks[1].begin - data.blocks[0].begin : 1'000'000'000;
  const storage::TimeRange range{begin, data.blocks.back().begin + length};
  const Scale x{0, static_cast<double>(range.end - range.begin) * 1e-9, panel.x, panel.right()};
  const Scale y{-1, 1, panel.bottom(), panel.y};
  const auto pixel = [&](storage::Time time) {
    return x(static_cast<double>(std::clamp(time, range.begin, range.end) - begin) * 1e-9);
  };
  Svg svg(page_width, page_height, data.title, record_style);
  svg.rectangle({0, 0, page_width, page_height}, "page");
  svg.text({20, 30}, data.title, "title");
  svg.text({20, 50}, data.subtitle, "small");
  const bool has_change = data.change && data.change->since >= begin;
  draw_legend(svg, has_change);
  for (const Tick& tick : time_ticks(range, 8)) {
    const double at = x(tick.value);
    svg.line({at, panel.y}, {at, panel.bottom()}, "grid");
    svg.text({at, panel.bottom() + 16}, tick.label, "small", "middle");
  }
  svg.text({panel.right(), panel.bottom() + 32}, "UTC", "small", "end");
  for (const Tick& tick : ticks_of(y, 5)) {
    svg.line({panel.x, y(tick.value)}, {panel.right(), y(tick.value)}, "grid");
    svg.text({panel.x - 6, y(tick.value) + 4}, tick.label, "small", "end");
  }
  svg.line({panel.x, y(0)}, {panel.right(), y(0)}, "zero");
  svg.rectangle(panel, "frame");
  svg.begin_group("scores");
  std::vector<Point> mean, lower;
  for (const ComparedBlock& block : data.blocks) {
    const double end = pixel(block.begin + length);
    svg.circle({(pixel(block.begin) + end) / 2, y(block.score)}, 2, "score");
    mean.push_back({end, y(block.mean)});
    lower.push_back({end, y(block.lower)});
  }
  svg.end_group();
  for (const auto& [id, line] : {std::pair("mean", &mean), std::pair("lower", &lower)}) {
    svg.begin_group(id);
    svg.polyline(*line, id);
    svg.end_group();
  }
  if (has_change) {
    svg.begin_group("change");
    svg.line({pixel(data.change->since), panel.y}, {pixel(data.change->since), panel.bottom()},
             "change");
    svg.end_group();
  }
  return std::move(svg).finish();
}

}  // namespace reident::cli
