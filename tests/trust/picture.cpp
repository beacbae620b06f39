#include "tests/trust/picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/svg.hpp"
#include "service/support/time_text.hpp"

namespace reident::trust {
namespace {

using cli::Scale;
using cli::Svg;

constexpr double width = 1100, left = 70, right = 1080;
constexpr double head = 90, truth_height = 130, error_height = 150, gap = 34;
constexpr double panel_height = truth_height + error_height + 2 * gap;
constexpr double day_ns = 86'400e9;

constexpr std::string_view style = R"(text{font:12px sans-serif;fill:#333}
.title{font-size:17px;font-weight:bold;fill:#111}
.small{font-size:11px;fill:#555}
.page{fill:#fff}
.frame{fill:none;stroke:#999}
.grid{stroke:#000;stroke-opacity:.1}
.life{fill:#2456b8;fill-opacity:.13}
.fault{fill:#d1480a;fill-opacity:.16}
.truth{fill:none;stroke:#222;stroke-width:1}
.champion{fill:none;stroke:#d1480a;stroke-width:1.4}
.oracle{fill:none;stroke:#1c8a4a;stroke-width:1.4}
.publication{stroke:#1c8a4a;stroke-width:1.2}
.wrong{stroke:#c00;stroke-width:2.5}
.drift{fill:#7a3fb0}
)";

struct Panel {
  Svg& svg;
  const ScenarioOutcome& outcome;
  Scale time;  // days after the start
  double top;

  double x(storage::Time when) const {
    return std::clamp(time(static_cast<double>(when - outcome.extent.begin) / day_ns), left, right);
  }

  void bands(double height) const {
    const auto band = [&](storage::Time begin, storage::Time end, std::string_view name) {
      // A step is a band of its own width until the end.
      svg.rectangle({x(begin), top, std::max(1.5, x(end) - x(begin)), height}, name);
    };
    for (const auto& event : outcome.events)
      band(event.begin, event.end > event.begin ? event.end : outcome.extent.end, "life");
    for (const satcs::Fault& fault : outcome.faults)
      band(fault.when.begin, fault.when.end, "fault");
  }

  void frame(const Scale& values, double height, std::string_view heading) const {
    for (const cli::Tick& tick : cli::ticks_of(values, 5)) {
      svg.line({left, values(tick.value)}, {right, values(tick.value)}, "grid");
      svg.text({left - 6, values(tick.value) + 4}, tick.label, "small", "end");
    }
    for (double day = 0; day <= time.high; day += 5)
      svg.text({time(day), top + height + 14}, fmt::format("day {:g}", day), "small", "middle");
    svg.rectangle({left, top, right - left, height}, "frame");
    svg.text({left, top - 5}, heading, "");
  }
};

void draw_truth(const Panel& panel, const EquipmentOutcome& equipment) {
  double low = INFINITY, high = -INFINITY;
  for (const Extremes& one : equipment.output) {
    low = std::min(low, one.low);
    high = std::max(high, one.high);
  }
  const Scale values = cli::scale_around(low, high, panel.top + truth_height, panel.top);
  std::vector<cli::Point> points;
  for (const Extremes& one : equipment.output) {
    points.push_back({panel.x(one.time), values(one.low)});
    points.push_back({panel.x(one.time), values(one.high)});
  }
  panel.bands(truth_height);
  panel.svg.polyline(points, "truth");
  panel.frame(values, truth_height, equipment.equipment + ": truth of the output");
}

std::vector<cli::Point> curve_points(const Panel& panel, const ErrorCurve& curve,
                                     const Scale& values) {
  std::vector<cli::Point> points;
  for (std::int64_t block = 0; block <= curve.block_of(panel.outcome.extent.end); ++block)
    if (const auto error = curve.mrse_percent(block, block + 1))
      points.push_back({panel.x(curve.begin_of(block)),
                        values(std::clamp(std::log10(*error), values.low, values.high))});
  return points;
}

void draw_errors(const Panel& panel, const EquipmentOutcome& equipment) {
  double low = INFINITY, high = -INFINITY;
  for (std::int64_t block = 0; block <= equipment.champion.block_of(panel.outcome.extent.end);
       ++block)
    if (const auto error = equipment.champion.mrse_percent(block, block + 1)) {
      low = std::min(low, std::log10(std::max(*error, 1e-4)));
      high = std::max(high, std::log10(std::clamp(*error, 1e-4, 1e4)));
    }
  const Scale values =
      cli::scale_around(low - 0.2, high + 0.1, panel.top + error_height, panel.top);
  panel.bands(error_height);
  panel.svg.polyline(curve_points(panel, equipment.champion, values), "champion");
  for (const ChangeScore& change : equipment.changes)
    panel.svg.polyline(curve_points(panel, change.oracle, values), "oracle");
  for (const Publication& publication : equipment.publications) {
    const double x = panel.x(publication.time);
    panel.svg.line({x, panel.top}, {x, panel.top + error_height},
                   publication.wrong() ? "wrong" : "publication");
  }
  for (const DriftRequest& drift : equipment.drifts)
    panel.svg.circle({panel.x(drift.time), panel.top + error_height - 5}, 3, "drift");
  panel.frame(values, error_height,
              equipment.equipment +
                  ": logarithm of the MRSE of each orbit in percent, of what "
                  "simulators ran and of the oracle");
}

}  // namespace

std::string picture(const ScenarioOutcome& outcome) {
  const double height = head + panel_height * static_cast<double>(outcome.equipment.size());
  Svg svg(width, height, fmt::format("Scenario {}", outcome.number), style);
  svg.rectangle({0, 0, width, height}, "page");
  svg.text(
      {20, 28},
      fmt::format("Scenario {}: life {}, fault {}", outcome.number, outcome.life, outcome.fault),
      "title");
  std::string faults;
  for (const satcs::Fault& fault : outcome.faults)
    faults += fmt::format("{} {} {} ", name(fault.kind), fault.parameter, fault.other);
  svg.text(
      {20, 48},
      fmt::format("From {}, seed {}. {}", time_text(outcome.extent.begin), outcome.seed, faults),
      "small");
  svg.text(
      {20, 64},
      "Blue: life. Orange bands: faults. Green lines: publications, red ones wrong. Dots: drift "
      "requests. Curves: orange what simulators ran, green the oracle.",
      "small");
  const double days = static_cast<double>(outcome.extent.end - outcome.extent.begin) / day_ns;
  double top = head;
  for (const EquipmentOutcome& equipment : outcome.equipment) {
    Panel panel{svg, outcome, {0, days, left, right}, top + 6};
    draw_truth(panel, equipment);
    panel.top += truth_height + gap;
    draw_errors(panel, equipment);
    top += panel_height;
  }
  return std::move(svg).finish();
}

}  // namespace reident::trust
