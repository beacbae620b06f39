#include "service/satcs/handwritten_eps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference_spacecraft.hpp"

namespace reident::satcs {
namespace {

constexpr storage::Time second_ns = 1'000'000'000;

struct Point {
  std::string_view name;
  double (*read)(const HandwrittenEps::Flows& flows);
};

using F = const HandwrittenEps::Flows&;

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
    Point{"I_SG2", [](F f) { return f.sg2_A; }},
    Point{"I_SHUNT", [](F f) { return f.shunt_A; }},
    Point{"I_BUS", [](F f) { return f.load_A; }},
    Point{"V_BUS", [](F f) { return f.bus_V; }},
    Point{"V_BAT1", [](F f) { return f.battery_V; }},
    Point{"V_BAT2", [](F f) { return f.battery_V; }},
    Point{"S_PAYLOAD", [](F f) { return f.on.payload ? 1.0 : 0.0; }},
    Point{"S_TX", [](F f) { return f.on.transmitter ? 1.0 : 0.0; }},
};

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
  for (const Point& point : points)
    samples.push_back({parameter_id(point.name), storage::Quality::good, point.read(flows_)});
}

void HandwrittenEps::advance() {
  constexpr double second_h = 1.0 / 3600;
  charge_ = std::clamp(charge_ + flows_.battery_A * second_h / constants_.capacity_Ah, 0.0, 1.0);
  time_ += second_ns;
  solve();
}

void HandwrittenEps::solve() {
  const HandwrittenConstants& c = constants_;
  const double sunlight = orbit_.illumination(time_);
  flows_.on = plan_.at(time_);
  const double load_W = c.platform_W + c.heaters_W +
                        (flows_.on.payload ? c.payload_W : c.payload_standby_W) +
                        (flows_.on.transmitter ? c.transmitter_W : 0.0);
  const double array_A = c.bus_array_A * sunlight;
  flows_.bus_V = c.bus_V;
  flows_.load_A = load_W / c.bus_V;
  flows_.sg2_A = std::min(flows_.load_A, array_A);
  flows_.shunt_A = array_A - flows_.sg2_A;
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

std::vector<storage::ParameterDescriptor> handwritten_descriptors(std::string_view spacecraft) {
  const auto all = reference::telemetry_descriptors(spacecraft);
  std::vector<storage::ParameterDescriptor> descriptors;
  for (const Point& point : points)
    descriptors.push_back(*std::find_if(all.begin(), all.end(),
                                        [&point](const auto& d) { return d.name == point.name; }));
  return descriptors;
}

}  // namespace reident::satcs
