#include "service/cli/output/model_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "identification/numerics/decompositions.hpp"
#include "service/cli/model_comparison.hpp"
#include "service/cli/output/axis.hpp"
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
constexpr double top = 104;
constexpr double bottom_height = 240;
constexpr double character_width = 5.8;  // of small text, about
// Four lines of two points of some 12 bytes for each column and output.
constexpr double max_trace_bytes = 400'000;

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
std::vector<TraceSegment> segments_of(const PictureData& data, const Vector& values) {
  const identification::Record& record = data.run.data.record;
  const double begin = static_cast<double>(data.range.begin) * 1e-9;
  std::vector<TraceSegment> segments;
  for (const identification::Segment& segment : record.segments) {
    TraceSegment drawn;
    for (Index row = segment.begin; row < segment.end; ++row) {
      const auto tick = static_cast<double>(segment.first_tick + (row - segment.begin));
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

Scale time_scale(const PictureData& data) {
  return {0, static_cast<double>(data.range.end - data.range.begin) * 1e-9, left, right};
}

void draw_head(Svg& svg, const PictureData& data) {
  svg.text({20, 30}, data.title, "title");
  svg.text({20, 50}, data.subtitle, "small");
  double x = 20;
  for (const auto& [css_class, label] :
       {std::pair("real", "measured"), std::pair("simulated", "free run of the model"),
        std::pair("error", "error of the free run"),
        std::pair("following", "error following telemetry")}) {
    if (std::string_view(css_class) == "following" && !data.run.tracked) continue;
    svg.line({x, 72}, {x + 24, 72}, css_class);
    svg.text({x + 30, 76}, label, "small");
    x += 44 + character_width * static_cast<double>(std::string_view(label).size());
  }
  for (const PicturePart& part : data.parts) {
    svg.rectangle({x, 65, 16, 14}, part.name);
    svg.text({x + 22, 76}, part.name, "small");
    x += 36 + character_width * static_cast<double>(part.name.size());
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
  svg.rectangle(box, "frame");
}

void draw_value_marks(Svg& svg, const Box& box, const Scale& y, int most) {
  for (const Tick& tick : ticks_of(y, most)) {
    svg.line({box.x, y(tick.value)}, {box.right(), y(tick.value)}, "grid");
    svg.text({box.x - 6, y(tick.value) + 4}, tick.label, "small", "end");
  }
}

void draw_line(Svg& svg, const PictureData& data, const std::string& id, const Vector& values,
               const Scale& y, std::string_view css_class) {
  const double room =
      max_trace_bytes / static_cast<double>(data.model.outputs.size()) / (4 * 2 * 12);
  const double column = std::max(1.0, (right - left) / room);
  svg.begin_group(id);
  for (const auto& line : trace(segments_of(data, values), time_scale(data), y, column))
    svg.polyline(line, css_class);
  svg.end_group();
}

/// The version's own scores, on its validation part; those of the run that is drawn where that part
/// is not in the picture.
std::string scores_text(const PictureData& data, Index q) {
  const EquipmentModel& model = data.model;
  const storage::TimeRange validated = model.validated_on;
  const bool is_shown = validated.begin >= data.range.begin && validated.end <= data.range.end;
  if (!is_shown && data.run.score.rows > 0)
    return fmt::format("this run: MRSE {:.3g} %, fit {:.1f} %", data.run.score.mrse_percent(q),
                       data.run.score.fit_percent(q));
  std::string text = fmt::format("validation: MRSE {:.3g} %, fit {:.1f} %",
                                 model.validation.mrse_percent(q), model.validation.fit_percent(q));
  if (model.tracking)
    text += fmt::format("; following telemetry: MRSE {:.3g} %",
                        model.tracking->validation.mrse_percent(q));
  return text;
}

void draw_output(Svg& svg, const PictureData& data, Index q, double y) {
  const Signal& output = data.model.outputs[static_cast<std::size_t>(q)];
  const Vector real = data.run.data.record.y.col(q), simulated = data.run.y_hat.col(q);
  const std::string unit = output.unit.empty() ? "" : " [" + output.unit + "]";
  const std::string id = fmt::format("output-{}", q + 1);
  const Box run{left, y, right - left, run_height};
  draw_time_frame(svg, data, run, false);
  // A run that goes far away must not flatten what was measured.
  const double low = real.minCoeff(), high = real.maxCoeff(), span = high - low;
  const Scale scale =
      scale_around(std::clamp(simulated.minCoeff(), low - span, low),
                   std::clamp(simulated.maxCoeff(), high, high + span), run.bottom(), run.y);
  draw_value_marks(svg, run, scale, 6);
  draw_line(svg, data, id + "-real", real, scale, "real");
  draw_line(svg, data, id + "-simulated", simulated, scale, "simulated");
  svg.text({left, y - 7}, output.name + unit, "heading");
  svg.text({right, y - 7}, scores_text(data, q), "small", "end");

  const Box box{left, run.bottom() + panel_gap, right - left, error_height};
  draw_time_frame(svg, data, box, true);
  const Vector error = real - simulated;
  const Scale error_scale = scale_around(
      std::clamp(std::min(0.0, error.minCoeff()), -2 * span - 1e-12, 0.0),
      std::clamp(std::max(0.0, error.maxCoeff()), 0.0, 2 * span + 1e-12), box.bottom(), box.y);
  draw_value_marks(svg, box, error_scale, 4);
  svg.line({left, error_scale(0)}, {right, error_scale(0)}, "zero");
  draw_line(svg, data, id + "-error", error, error_scale, "error");
  if (data.run.tracked)
    draw_line(svg, data, id + "-following", real - data.run.tracked->y_hat.col(q), error_scale,
              "following");
  svg.turned_text({22, box.y + box.height / 2}, "error" + unit, "small");
}

void draw_singular_values(Svg& svg, const PictureData& data, const Box& box) {
  svg.text({box.x, box.y - 7}, "singular values", "heading");
  std::vector<double> values;  // that have a logarithm
  for (const double value : data.singular_values)
    if (value > 0 && values.size() < 60) values.push_back(value);
  if (values.empty()) {
    svg.text({box.x, box.y + 16}, "not recorded", "small");
    return;
  }
  svg.begin_group("singular-values");
  const double most = std::floor(std::log10(values.front()) + 0.1) + 1;  // room above
  const double least = std::floor(std::log10(values.back()));
  const Scale y{least, most, box.bottom(), box.y};
  const Scale x{0.5, static_cast<double>(values.size()) + 0.5, box.x, box.right()};
  const double step = std::max(1.0, std::ceil((most - least) / 6));
  for (double power = least; power <= most; power += step) {
    svg.line({box.x, y(power)}, {box.right(), y(power)}, "grid");
    svg.text({box.x - 6, y(power) + 4}, fmt::format("1e{:.0f}", power), "small", "end");
  }
  for (const Tick& tick : ticks_of(x, 10))
    if (tick.value == std::floor(tick.value))
      svg.text({x(tick.value), box.bottom() + 16}, fmt::format("{:.0f}", tick.value), "small",
               "middle");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Point at{x(static_cast<double>(i + 1)), y(std::log10(values[i]))};
    svg.line({at.x, box.bottom()}, at, "stem");
    svg.circle(at, 3, "value");
  }
  svg.rectangle(box, "frame");
  svg.end_group();
  const double order = x(static_cast<double>(data.model.dynamics.order()) + 0.5);
  svg.line({order, box.y}, {order, box.bottom()}, "order");
  svg.text({order + 6, box.y + 16}, fmt::format("order {}", data.model.dynamics.order()), "small");
  svg.text({box.x + box.width / 2, box.bottom() + 34}, "number", "small", "middle");
}

std::string duration_words(double seconds) {
  if (seconds < 10'000) return fmt::format("{:.3g} s", seconds);
  if (seconds < 200'000) return fmt::format("{:.3g} h", seconds / 3600);
  return seconds < 1e10 ? fmt::format("{:.3g} d", seconds / 86400) : "never decays";
}

void draw_pole_list(Svg& svg, const PictureData& data, double x, double y) {
  constexpr std::size_t most = 10;
  const std::vector<Pole> poles = poles_of(data.model.dynamics);
  svg.text({x, y}, "time constants", "heading");
  for (std::size_t i = 0; i < std::min(most, poles.size()); ++i) {
    std::string words = duration_words(poles[i].time_constant_s);
    if (poles[i].frequency_hz > 0) words += fmt::format(", {:.3g} Hz", poles[i].frequency_hz);
    svg.text({x, y + 18 + 16 * static_cast<double>(i)}, words, "small");
  }
  if (poles.size() > most)
    svg.text({x, y + 18 + 16 * static_cast<double>(most)},
             fmt::format("and {} more", poles.size() - most), "small");
}

void draw_poles(Svg& svg, const PictureData& data, const Box& box) {
  svg.text({box.x, box.y - 7}, "poles in the unit circle", "heading");
  const identification::StateSpaceModel& dynamics = data.model.dynamics;
  const double reach = 1.15 * std::max(1.0, spectral_radius(dynamics));
  const Scale x{-reach, reach, box.x, box.right()}, y{-reach, reach, box.bottom(), box.y};
  for (const double mark : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    svg.line({x(mark), box.y}, {x(mark), box.bottom()}, "grid");
    svg.line({box.x, y(mark)}, {box.right(), y(mark)}, "grid");
    svg.text({x(mark), box.bottom() + 16}, fmt::format("{:g}", mark), "small", "middle");
    svg.text({box.x - 6, y(mark) + 4}, fmt::format("{:g}", mark), "small", "end");
  }
  svg.rectangle(box, "frame");
  svg.circle({x(0), y(0)}, x(1) - x(0), "circle");
  svg.text({box.x + box.width / 2, box.bottom() + 34}, "real part", "small", "middle");
  svg.turned_text({box.x - 38, box.y + box.height / 2}, "imaginary part", "small");
  svg.begin_group("poles");
  if (dynamics.order() > 0)
    for (const std::complex<double>& pole : identification::eigenvalues(dynamics.A))
      svg.cross({x(pole.real()), y(pole.imag())}, 5, "pole");
  svg.end_group();
  draw_pole_list(svg, data, box.right() + 16, box.y + 10);
}

}  // namespace

std::string model_picture(const PictureData& data) {
  const auto outputs = static_cast<Index>(data.model.outputs.size());
  const double height = top + static_cast<double>(outputs) * output_height() + bottom_height + 60;
  Svg svg(width, height, data.title, style);
  svg.rectangle({0, 0, width, height}, "page");
  draw_head(svg, data);
  double y = top;
  for (Index q = 0; q < outputs; ++q, y += output_height()) draw_output(svg, data, q, y);
  draw_singular_values(svg, data, {left, y + 24, 400, bottom_height - 24});
  draw_poles(svg, data, {600, y + 24, bottom_height - 24, bottom_height - 24});
  return std::move(svg).finish();
}

}  // namespace reident::cli
