#include "service/satcs/reference/handwritten_eps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"

namespace reident::satcs {
namespace {

struct Point {
  std::string_view name;
  double (*read)(const HandwrittenEps::Flows& flows);
};

using F = const HandwrittenEps::Flows&;

/// Whether the channel with this number, from 1, is shunted for at least half of its time.
double shunted(F flows, double channel) {
  const double channel_A = flows.array_A / reference::shunt_channels;
  return flows.shunt_A > 0 && flows.shunt_A >= (channel - 0.5) * channel_A ? 1 : 0;
}

constexpr std::array points = {
    Point{"I_BDRIN1", [](F f) { return f.bdr_in_A; }},
    Point{"I_BDRIN2", [](F f) { return f.bdr_in_A; }},
    Point{"I_BDROUT", [](F f) { return f.bdr_out_A; }},
    Point{"I_BAT1", [](F f) { return f.battery_A; }},
    Point{"I_BAT2", [](F f) { return f.battery_A; }},
    Point{"I_SAG1A", [](F f) { return f.section_A; }},
    Point{"I_SAG1B", [](F f) { return f.section_A; }},
    Point{"I_SGBCHC", [](F f) { return f.charge_A; }},
    Point{"I_SGBCHC2", [](F f) { return f.charge_A; }},
    Point{"I_CSH1", [](F f) { return f.section_A - f.charge_A; }},
    Point{"I_CSH2", [](F f) { return f.section_A - f.charge_A; }},
    Point{"I_SAG2", [](F f) { return f.array_A; }},
    Point{"I_SG2", [](F f) { return f.sg2_A; }},
    Point{"I_SHUNT", [](F f) { return f.shunt_A; }},
    Point{"I_BUS", [](F f) { return f.load_A; }},
    Point{"I_DIST", [](F f) { return f.load_A; }},
    Point{"V_BUS", [](F f) { return f.bus_V; }},
    Point{"V_BUSD", [](F f) { return f.bus_V; }},
    Point{"V_BAT1", [](F f) { return f.battery_V; }},
    Point{"V_BAT2", [](F f) { return f.battery_V; }},
    Point{"V_SAG1A", [](F f) { return f.battery_V; }},
    Point{"V_SAG1B", [](F f) { return f.battery_V; }},
    Point{"V_CHC1", [](F f) { return f.battery_V; }},
    Point{"V_CHC2", [](F f) { return f.battery_V; }},
    Point{"V_BDRIN1", [](F f) { return f.battery_V; }},
    Point{"V_BDRIN2", [](F f) { return f.battery_V; }},
    Point{"I_PF", [](F f) { return f.platform_A; }},
    Point{"I_TX", [](F f) { return f.transmitter_A; }},
    Point{"I_HTR", [](F f) { return f.heaters_A; }},
    Point{"I_DC1IN", [](F f) { return f.converter_A[0]; }},
    Point{"I_DC2IN", [](F f) { return f.converter_A[1]; }},
    Point{"I_DC3IN", [](F f) { return f.converter_A[2]; }},
    Point{"I_DC1OUT", [](F f) { return f.line_A[0]; }},
    Point{"I_DC2OUT", [](F f) { return f.line_A[1]; }},
    Point{"I_DC3OUT", [](F f) { return f.line_A[2]; }},
    Point{"I_SD1", [](F f) { return f.line_A[0]; }},
    Point{"I_SD2", [](F f) { return f.line_A[1]; }},
    Point{"I_SD3", [](F f) { return f.line_A[2]; }},
    Point{"V_DC1OUT", [](F f) { return f.line_V[0]; }},
    Point{"V_DC2OUT", [](F f) { return f.line_V[1]; }},
    Point{"V_DC3OUT", [](F f) { return f.line_V[2]; }},
    Point{"S_PAYLOAD", [](F f) { return f.on.payload ? 1.0 : 0.0; }},
    Point{"S_TX", [](F f) { return f.on.transmitter ? 1.0 : 0.0; }},
    Point{"S_SAFE", [](F f) { return f.on.safe_mode ? 1.0 : 0.0; }},
    Point{"S_SH1", [](F f) { return shunted(f, 1); }},
    Point{"S_SH2", [](F f) { return shunted(f, 2); }},
    Point{"S_SH3", [](F f) { return shunted(f, 3); }},
    Point{"S_SH4", [](F f) { return shunted(f, 4); }},
    Point{"S_SH5", [](F f) { return shunted(f, 5); }},
    Point{"S_SH6", [](F f) { return shunted(f, 6); }},
};

/// The spacecraft's points of the same names, in their order here.
const std::vector<reference::TelemetryPoint>& points_of_spacecraft() {
  static const auto all = [] {
    const auto known = reference::telemetry_points();
    std::vector<reference::TelemetryPoint> found;
    for (const Point& point : points)
      found.push_back(*std::find_if(known.begin(), known.end(),
                                    [&point](const auto& one) { return one.name == point.name; }));
    return found;
  }();
  return all;
}

}  // namespace

HandwrittenEps::HandwrittenEps(const reference::Constants& spacecraft,
                               std::vector<reference::LifeEvent> life, storage::Time start,
                               std::uint64_t seed)
    : orbit_(spacecraft.orbit),
      plan_(orbit_, spacecraft.load, std::move(life), seed),
      time_(reference::whole_seconds(start)),
      charge_(constants_.initial_charge) {
  solve();
}

void HandwrittenEps::read(std::vector<storage::Sample>& samples) const {
  samples.clear();
  const auto& rates = points_of_spacecraft();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!rates[k].due(time_ / storage::second_ns)) continue;
    samples.push_back(
        {parameter_id(points[k].name), storage::Quality::good, points[k].read(flows_)});
  }
}

void HandwrittenEps::advance() {
  constexpr double second_h = 1.0 / 3600;
  charge_ = std::clamp(charge_ + flows_.battery_A * second_h / constants_.capacity_Ah, 0.0, 1.0);
  time_ += storage::second_ns;
  solve();
}

void HandwrittenEps::solve() {
  const HandwrittenConstants& c = constants_;
  const double sunlight = orbit_.illumination(time_);
  flows_.on = plan_.at(time_);
  solve_loads();
  flows_.array_A = c.bus_array_A * sunlight;
  flows_.bus_V = c.bus_V;
  flows_.sg2_A = std::min(flows_.load_A, flows_.array_A);
  flows_.shunt_A = flows_.array_A - flows_.sg2_A;
  flows_.bdr_out_A = flows_.load_A - flows_.sg2_A;
  flows_.section_A = c.charge_array_A * sunlight;

  const double open_V = c.empty_V + charge_ * (c.full_V - c.empty_V);
  flows_.bdr_in_A =
      c.bus_V * flows_.bdr_out_A / c.bdr_efficiency / open_V / double(reference::battery_count);
  // A full battery takes no more than the regulator draws.
  flows_.charge_A = charge_ < 1 ? flows_.section_A : std::min(flows_.section_A, flows_.bdr_in_A);
  flows_.battery_A = flows_.charge_A - flows_.bdr_in_A;
  flows_.battery_V = open_V + c.battery_ohm * flows_.battery_A;
}

void HandwrittenEps::solve_loads() {
  const HandwrittenConstants& c = constants_;
  flows_.platform_A = (flows_.on.safe_mode ? c.platform_safe_W : c.platform_W) / c.bus_V;
  flows_.transmitter_A = flows_.on.transmitter ? c.transmitter_W / c.bus_V : 0;
  flows_.heaters_A = c.heaters_W / c.bus_V;
  flows_.load_A = flows_.platform_A + flows_.transmitter_A + flows_.heaters_A;
  for (std::size_t l = 0; l < reference::converter_count; ++l) {
    const auto& line = c.line[l];
    const bool is_off = flows_.on.safe_mode && l == reference::camera_line;
    flows_.line_V[l] = line.output_V;
    flows_.line_A[l] = is_off ? 0
                              : line.base_A + (flows_.on.payload ? line.payload_A : 0.0) +
                                    (flows_.on.transmitter ? line.transmitter_A : 0.0);
    flows_.converter_A[l] = line.output_V * flows_.line_A[l] / c.converter_efficiency / c.bus_V;
    flows_.load_A += flows_.converter_A[l];
  }
}

std::vector<storage::ParameterDescriptor> handwritten_descriptors(std::string_view spacecraft) {
  const auto all = reference::telemetry_descriptors(spacecraft);
  std::vector<storage::ParameterDescriptor> descriptors;
  for (const Point& point : points)
    descriptors.push_back(*std::find_if(all.begin(), all.end(),
                                        [&point](const auto& d) { return d.name == point.name; }));
  return descriptors;
}

}  // namespace reident::satcs
