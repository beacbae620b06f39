#include "service/cli/output/model_picture.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/dynamics_panels.hpp"
#include "service/cli/output/svg.hpp"
#include "service/cli/output/trace.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;

constexpr double width = 1000;
constexpr double left = 84, right = 980;  // of the panels over time
constexpr double run_height = 180, error_height = 90, panel_gap = 12, output_gap = 52;
constexpr double input_height = 56, input_gap = 30;
constexpr double top = 104;
constexpr double bottom_height = 240;
constexpr double character_width = 5.8;  // of small text, about
// A line has two points of some 12 bytes for each column.
constexpr double max_trace_bytes = 400'000, bytes_of_column = 2 * 12;

constexpr std::string_view style = R"(text{font:12px sans-serif;fill:#333}
.title{font-size:18px;font-weight:bold;fill:#111}
.heading{font-size:13px;font-weight:bold;fill:#111}
.small{font-size:11px;fill:#555}
.page{fill:#fff}
.frame{fill:none;stroke:#999;stroke-width:1}
.grid{stroke:#000;stroke-opacity:.1;stroke-width:1}
.zero{stroke:#777;stroke-width:1}
.identify{fill:#e8effa}
.tune{fill:#fdf3d0}
.validate{fill:#e2f3e1}
.excluded{fill:#f4c7c7}
.change{stroke:#b00020;stroke-width:1.5;stroke-dasharray:2 3}
.input{fill:none;stroke:#555;stroke-width:1}
.other{fill:none;stroke:#7b3fb5;stroke-width:1.2;stroke-opacity:.85}
.real{fill:none;stroke:#222;stroke-width:1.2}
.simulated{fill:none;stroke:#d1480a;stroke-width:1.2;stroke-opacity:.85}
.error{fill:none;stroke:#2456b8;stroke-width:1}
.following{fill:none;stroke:#1c8a4a;stroke-width:1.2}
.value{fill:#2456b8}
.stem{stroke:#2456b8;stroke-opacity:.4;stroke-width:1.5}
.order{stroke:#d1480a;stroke-width:1.2;stroke-dasharray:5 4}
.circle{fill:none;stroke:#777;stroke-width:1.2}
.pole{fill:none;stroke:#d1480a;stroke-width:2}
polyline{stroke-linejoin:round;stroke-linecap:round}
)";

/// The values of one column of a matrix over the rows of the run.
std::vector<TraceSegment> segments_of(const identification::Record& record, storage::Time start,
                                      const Vector& values) {
  const double begin = static_cast<double>(start) * 1e-9;
  std::vector<TraceSegment> segments;
  for (const identification::Segment& segment : record.segments) {
    TraceSegment drawn;
    for (Index row = segment.begin; row < segment.end; ++row) {
      const auto tick = static_cast<double>(segment.tick_of(row));
      drawn.x.push_back(tick * record.period_s - begin);
      drawn.y.push_back(values(row));
    }
    segments.push_back(std::move(drawn));
  }
  return segments;
}

constexpr double output_height() {
  return run_height + panel_gap + error_height + output_gap;
}

/// Lines over time: of an output measured, simulated and both errors, and two of another version.
double lines_of(const PictureData& data) {
  const std::size_t of_output = data.other ? 6 : 4;
  return static_cast<double>(of_output * data.model.outputs.size() + data.model.inputs.size());
}

std::string_view label_of(const PicturePart& part) {
  return part.name == "excluded" ? "left out" : std::string_view(part.name);
}

Scale time_scale(const PictureData& data) {
  return {0, static_cast<double>(data.range.end - data.range.begin) * 1e-9, left, right};
}

bool is_change_shown(const PictureData& data) {
  return data.change && *data.change >= data.range.begin && *data.change < data.range.end;
}

void draw_head(Svg& svg, const PictureData& data) {
  svg.text({20, 30}, data.title, "title");
  svg.text({20, 50}, data.subtitle, "small");
  double x = 20;
  std::vector<std::pair<std::string_view, std::string>> lines = {
      {"real", "measured"},
      {"simulated", data.other ? "free run" : "free run of the model"},
      {"error", "error of the free run"}};
  if (data.run.tracked) lines.emplace_back("following", "error following telemetry");
  if (data.other) lines.emplace_back("other", data.other->name);
  if (is_change_shown(data)) lines.emplace_back("change", "change");
  for (const auto& [css_class, label] : lines) {
    svg.line({x, 72}, {x + 24, 72}, css_class);
    svg.text({x + 30, 76}, label, "small");
    x += 44 + character_width * static_cast<double>(label.size());
  }
  std::set<std::string_view> listed;
  for (const PicturePart& part : data.parts) {
    if (!listed.insert(part.name).second) continue;
    const std::string_view label = label_of(part);
    svg.rectangle({x, 65, 16, 14}, part.name);
    svg.text({x + 22, 76}, std::string(label), "small");
    x += 36 + character_width * static_cast<double>(label.size());
  }
}

/// Shades the parts and draws the frame with marks of time, and labels of time where they are
/// `labelled`.
void draw_time_frame(Svg& svg, const PictureData& data, const Box& box, bool labelled) {
  const Scale x = time_scale(data);
  const auto pixel = [&](storage::Time time) {
    const storage::Time inside = std::clamp(time, data.range.begin, data.range.end);
    return x(static_cast<double>(inside - data.range.begin) * 1e-9);
  };
  for (const PicturePart& part : data.parts) {
    const double from = pixel(part.range.begin), to = pixel(part.range.end);
    if (to > from) svg.rectangle({from, box.y, to - from, box.height}, part.name);
  }
  for (const Tick& tick : time_ticks(data.range, 8)) {
    const double at = x(tick.value);
    svg.line({at, box.y}, {at, box.bottom()}, "grid");
    if (labelled) svg.text({at, box.bottom() + 16}, tick.label, "small", "middle");
  }
  if (labelled) svg.text({right, box.bottom() + 32}, "UTC", "small", "end");
  if (is_change_shown(data))
    svg.line({pixel(*data.change), box.y}, {pixel(*data.change), box.bottom()}, "change");
  svg.rectangle(box, "frame");
}

void draw_value_marks(Svg& svg, const Box& box, const Scale& y, int most) {
  for (const Tick& tick : ticks_of(y, most)) {
    svg.line({box.x, y(tick.value)}, {box.right(), y(tick.value)}, "grid");
    svg.text({box.x - 6, y(tick.value) + 4}, tick.label, "small", "end");
  }
}

void draw_line(Svg& svg, const PictureData& data, const identification::Record& record,
               const std::string& id, const Vector& values, const Scale& y,
               std::string_view css_class) {
  const double column =
      std::max(1.0, (right - left) * lines_of(data) * bytes_of_column / max_trace_bytes);
  svg.begin_group(id);
  for (const auto& line :
       trace(segments_of(record, data.range.begin, values), time_scale(data), y, column))
    svg.polyline(line, css_class);
  svg.end_group();
}

/// The version's own scores, on its validation part; those of the run that is drawn where that part
/// is not in the picture.
std::string scores_text(const PictureData& data, Index q) {
  const EquipmentModel& model = data.model;
  const storage::TimeRange validated = model.validated_on;
  const bool is_shown = validated.begin >= data.range.begin && validated.end <= data.range.end;
  if ((!is_shown || data.other) && data.run.score.rows > 0) {
    std::string text = fmt::format("this run: MRSE {:.3g} %, fit {:.1f} %",
                                   data.run.score.mrse_percent(q), data.run.score.fit_percent(q));
    if (data.other)
      text +=
          fmt::format("; {}: MRSE {:.3g} %, fit {:.1f} %", data.other->name,
                      data.other->run.score.mrse_percent(q), data.other->run.score.fit_percent(q));
    return text;
  }
  std::string text = fmt::format("validation: MRSE {:.3g} %, fit {:.1f} %",
                                 model.validation.mrse_percent(q), model.validation.fit_percent(q));
  if (model.tracking)
    text += fmt::format("; following telemetry: MRSE {:.3g} %",
                        model.tracking->validation.mrse_percent(q));
  return text;
}

/// One version's run of an output.
struct OutputRun {
  const identification::Record& record;
  Vector simulated, error;
};

OutputRun output_run(const ModelRun& run, Index q) {
  const identification::Record& record = run.data.record;
  return {record, run.y_hat.col(q), record.y.col(q) - run.y_hat.col(q)};
}

void draw_output(Svg& svg, const PictureData& data, Index q, double y) {
  const Signal& output = data.model.outputs[static_cast<std::size_t>(q)];
  const OutputRun own = output_run(data.run, q);
  const OutputRun other = output_run(data.other ? data.other->run : data.run, q);
  const Vector real = own.record.y.col(q);
  const std::string unit = output.unit.empty() ? "" : " [" + output.unit + "]";
  const std::string id = fmt::format("output-{}", q + 1);
  const Box run{left, y, right - left, run_height};
  draw_time_frame(svg, data, run, false);
  const auto least = [](const Vector& a, const Vector& b) {
    return std::min(a.minCoeff(), b.minCoeff());
  };
  const auto most = [](const Vector& a, const Vector& b) {
    return std::max(a.maxCoeff(), b.maxCoeff());
  };
  // A run that goes far away must not flatten what was measured.
  const double low = real.minCoeff(), high = real.maxCoeff(), span = high - low;
  const Scale scale = scale_around(
      std::clamp(least(own.simulated, other.simulated), low - span, low),
      std::clamp(most(own.simulated, other.simulated), high, high + span), run.bottom(), run.y);
  draw_value_marks(svg, run, scale, 6);
  draw_line(svg, data, own.record, id + "-real", real, scale, "real");
  draw_line(svg, data, own.record, id + "-simulated", own.simulated, scale, "simulated");
  if (data.other)
    draw_line(svg, data, other.record, id + "-other", other.simulated, scale, "other");
  svg.text({left, y - 7}, output.name + unit, "heading");
  svg.text({right, y - 7}, scores_text(data, q), "small", "end");

  const Box box{left, run.bottom() + panel_gap, right - left, error_height};
  draw_time_frame(svg, data, box, true);
  const double farthest = 2 * span + 1e-12;
  const Scale error_scale =
      scale_around(std::clamp(least(own.error, other.error), -farthest, 0.0),
                   std::clamp(most(own.error, other.error), 0.0, farthest), box.bottom(), box.y);
  draw_value_marks(svg, box, error_scale, 4);
  svg.line({left, error_scale(0)}, {right, error_scale(0)}, "zero");
  draw_line(svg, data, own.record, id + "-error", own.error, error_scale, "error");
  if (data.run.tracked)
    draw_line(svg, data, own.record, id + "-following", real - data.run.tracked->y_hat.col(q),
              error_scale, "following");
  if (data.other)
    draw_line(svg, data, other.record, id + "-other-error", other.error, error_scale, "other");
  svg.turned_text({22, box.y + box.height / 2}, "error" + unit, "small");
}

void draw_input(Svg& svg, const PictureData& data, Index i, double y) {
  const Signal& input = data.model.inputs[static_cast<std::size_t>(i)];
  const Vector values = data.run.data.record.u.col(i);
  const Box box{left, y, right - left, input_height};
  draw_time_frame(svg, data, box, false);
  const Scale scale = scale_around(values.minCoeff(), values.maxCoeff(), box.bottom(), box.y);
  draw_value_marks(svg, box, scale, 3);
  draw_line(svg, data, data.run.data.record, fmt::format("input-{}", i + 1), values, scale,
            "input");
  svg.text({left, y - 7}, input.name + (input.unit.empty() ? "" : " [" + input.unit + "]"),
           "heading");
}

}  // namespace

std::string model_picture(const PictureData& data) {
  const auto outputs = static_cast<Index>(data.model.outputs.size());
  const auto inputs = static_cast<Index>(data.model.inputs.size());
  const double height = top + static_cast<double>(outputs) * output_height() +
                        static_cast<double>(inputs) * (input_height + input_gap) + bottom_height +
                        60;
  Svg svg(width, height, data.title, style);
  svg.rectangle({0, 0, width, height}, "page");
  draw_head(svg, data);
  double y = top;
  for (Index q = 0; q < outputs; ++q, y += output_height()) draw_output(svg, data, q, y);
  for (Index i = 0; i < inputs; ++i, y += input_height + input_gap) draw_input(svg, data, i, y);
  draw_singular_values(svg, data.singular_values, data.model.dynamics.order(),
                       {left, y + 24, 400, bottom_height - 24});
  draw_poles(svg, data.model.dynamics, {600, y + 24, bottom_height - 24, bottom_height - 24});
  return std::move(svg).finish();
}

}  // namespace reident::cli
