#include "service/satcs/platform/handwritten_platform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/platform/platform_telemetry.hpp"
#include "service/satcs/reference/sensed_plant.hpp"

namespace reident::satcs::platform {
namespace {

using State = HandwrittenPlatform::State;
using S = const State&;

struct SimulatedPoint {
  std::string_view name;
  double (*read)(const State& state);
};

constexpr std::array simulated_points = {
    SimulatedPoint{"TQ_RW1", [](S s) { return s.command_Nm[0]; }},
    SimulatedPoint{"TQ_RW2", [](S s) { return s.command_Nm[1]; }},
    SimulatedPoint{"TQ_RW3", [](S s) { return s.command_Nm[2]; }},
    SimulatedPoint{"W_RW1", [](S s) { return s.speed_rad_s[0]; }},
    SimulatedPoint{"W_RW2", [](S s) { return s.speed_rad_s[1]; }},
    SimulatedPoint{"W_RW3", [](S s) { return s.speed_rad_s[2]; }},
    SimulatedPoint{"IM_RW1", [](S s) { return s.motor_A[0]; }},
    SimulatedPoint{"IM_RW2", [](S s) { return s.motor_A[1]; }},
    SimulatedPoint{"IM_RW3", [](S s) { return s.motor_A[2]; }},
    SimulatedPoint{"I_RW1", [](S s) { return s.supply_A[0]; }},
    SimulatedPoint{"I_RW2", [](S s) { return s.supply_A[1]; }},
    SimulatedPoint{"I_RW3", [](S s) { return s.supply_A[2]; }},
    SimulatedPoint{"D_PA", [](S s) { return s.drive_mW; }},
    SimulatedPoint{"P_PA", [](S s) { return s.output_W; }},
    SimulatedPoint{"I_PA", [](S s) { return s.amplifier_A; }},
    SimulatedPoint{"I_PAD", [](S s) { return s.amplifier_A; }},
    SimulatedPoint{"S_PA", [](S s) { return s.drive_mW > 0 ? 1.0 : 0.0; }},
    SimulatedPoint{"I_ELEC", [](S s) { return s.electronics_A; }},
    SimulatedPoint{"V_HB", [](S s) { return s.bus_V; }},
    SimulatedPoint{"V_HBB", [](S s) { return s.bus_V; }},
    SimulatedPoint{"I_H1", [](S s) { return s.heater_A[0]; }},
    SimulatedPoint{"I_H2", [](S s) { return s.heater_A[1]; }},
    SimulatedPoint{"I_H3", [](S s) { return s.heater_A[2]; }},
    SimulatedPoint{"I_H4", [](S s) { return s.heater_A[3]; }},
    SimulatedPoint{"C_SSZ", [](S s) { return s.sun_mA[zenith_panel]; }},
    SimulatedPoint{"C_SSN", [](S s) { return s.sun_mA[nadir_panel]; }},
    SimulatedPoint{"C_SSS", [](S s) { return s.sun_mA[sun_panel]; }},
    SimulatedPoint{"S_PSAFE", [](S s) { return s.safe_mode ? 1.0 : 0.0; }},
    SimulatedPoint{"T_PZEN", [](S s) { return s.panel_C[zenith_panel]; }},
    SimulatedPoint{"T_PNAD", [](S s) { return s.panel_C[nadir_panel]; }},
    SimulatedPoint{"T_PSUN", [](S s) { return s.panel_C[sun_panel]; }},
    SimulatedPoint{"T_PSPC", [](S s) { return s.panel_C[space_panel]; }},
    SimulatedPoint{"T_DECK", [](S s) { return s.heated_C[0]; }},
    SimulatedPoint{"T_WPL", [](S s) { return s.heated_C[1]; }},
    SimulatedPoint{"T_TPL", [](S s) { return s.heated_C[2]; }},
    SimulatedPoint{"T_TANK", [](S s) { return s.heated_C[3]; }},
    SimulatedPoint{"T_RW1", [](S s) { return s.bearing_C; }},
    SimulatedPoint{"T_RW2", [](S s) { return s.bearing_C; }},
    SimulatedPoint{"T_RW3", [](S s) { return s.bearing_C; }},
    SimulatedPoint{"T_PA", [](S s) { return s.amplifier_C; }},
};

/// The spacecraft's points of the same names, in their order here.
const std::vector<reference::PointInfo>& rates() {
  static const auto all = [] {
    const auto known = telemetry_points();
    std::vector<reference::PointInfo> found;
    for (const SimulatedPoint& point : simulated_points)
      found.push_back(*std::find_if(known.begin(), known.end(),
                                    [&point](const auto& one) { return one.name == point.name; }));
    return found;
  }();
  return all;
}

}  // namespace

HandwrittenPlatform::HandwrittenPlatform(const Constants& spacecraft,
                                         std::vector<reference::LifeEvent> life,
                                         storage::Time start, std::uint64_t seed)
    : spacecraft_(spacecraft),
      orbit_(spacecraft.orbit),
      plan_(orbit_, spacecraft.plan, life, seed),
      slews_(orbit_, spacecraft.slew, life, seed),
      drives_(orbit_, spacecraft, life, seed),
      time_(reference::whole_seconds(start)) {
  state_.bus_V = constants_.bus_V;
  state_.panel_C = constants_.panel_sink_C;
  state_.heated_C = constants_.heated_C;
  state_.bearing_C = constants_.bearing_C;
  state_.amplifier_C = constants_.heated_C[2];
  for (std::size_t k = 0; k < wheel_count; ++k)
    state_.speed_rad_s[k] = spacecraft_.axis[k].bias_rad_s;
  for (std::size_t h = 0; h < heater_count; ++h)
    state_.heater_A[h] =
        constants_.heater_duty * spacecraft_.thermal.heater[h].rated_W / constants_.bus_V;
  solve();
}

void HandwrittenPlatform::read(std::vector<storage::Sample>& samples) const {
  samples.clear();
  for (std::size_t k = 0; k < simulated_points.size(); ++k) {
    if (!rates()[k].due(time_ / storage::second_ns)) continue;
    samples.push_back({parameter_id(simulated_points[k].name), storage::Quality::good,
                       simulated_points[k].read(state_)});
  }
}

void HandwrittenPlatform::advance() {
  const HandwrittenPlatformConstants& c = constants_;
  State& s = state_;
  for (std::size_t p = 0; p < panel_count; ++p) {
    const double sun_W = c.panel_absorptance * c.panel_area_m2 *
                         spacecraft_.environment.solar_flux_W_m2 * s.sun_mA[p] /
                         spacecraft_.environment.sun_sensor_mA;
    s.panel_C[p] +=
        (sun_W - c.panel_W_K * (s.panel_C[p] - c.panel_sink_C[p])) / c.panel_capacity_J_K;
  }
  for (std::size_t k = 0; k < wheel_count; ++k) {
    const double friction_Nm = c.wheel_viscous_Nms * s.speed_rad_s[k];
    s.speed_rad_s[k] += (s.command_Nm[k] - friction_Nm) / spacecraft_.wheel[k].inertia_kg_m2;
  }
  const double heat_W = s.amplifier_A * c.bus_V - s.output_W;
  s.amplifier_C += (heat_W - c.amplifier_W_K * (s.amplifier_C - s.heated_C[2])) / c.amplifier_J_K;
  time_ += storage::second_ns;
  solve();
}

void HandwrittenPlatform::solve() {
  const HandwrittenPlatformConstants& c = constants_;
  State& s = state_;
  const auto on = plan_.at(time_);
  const Sunlight sunlight = sunlight_at(orbit_, spacecraft_.environment, time_);
  s.safe_mode = on.safe_mode;
  s.electronics_A =
      ((on.safe_mode ? c.safe_W : c.electronics_W) + (on.payload ? c.payload_W : 0.0)) / c.bus_V;
  for (std::size_t p = 0; p < panel_count; ++p)
    s.sun_mA[p] =
        spacecraft_.environment.sun_sensor_mA *
        (sunlight.direct[p] + spacecraft_.thermal.panel[p].earth_view * sunlight.reflected);
  const double phase = orbit_.count(time_).phase;
  for (std::size_t k = 0; k < wheel_count; ++k) {
    const AxisConstants& axis = spacecraft_.axis[k];
    const double off = s.speed_rad_s[k] - axis.bias_rad_s;
    unloads_[k] = std::abs(off) > (unloads_[k] ? axis.unload_until_rad_s : axis.unload_from_rad_s);
    const double unloading_Nm = unloads_[k] ? std::copysign(axis.unload_Nm, -off) : 0;
    s.command_Nm[k] = c.gravity_Nm * std::cos(2 * std::numbers::pi * phase) + unloading_Nm -
                      axis.body_kg_m2 * slews_.acceleration(k, axis.slew_deg, time_) +
                      c.wheel_viscous_Nms * s.speed_rad_s[k];
    s.motor_A[k] = s.command_Nm[k] / spacecraft_.wheel[k].torque_Nm_A;
    const double mechanical_W = std::max(s.command_Nm[k] * s.speed_rad_s[k], 0.0);
    s.supply_A[k] = (c.wheel_idle_W + mechanical_W / c.wheel_efficiency) / c.bus_V;
  }
  s.drive_mW = drives_.drive_mW(time_);
  s.output_W = 1e-3 * c.gain * s.drive_mW;
  s.amplifier_A = s.drive_mW > 0 ? (c.quiescent_W + s.output_W / c.efficiency) / c.bus_V : 0;
}

std::vector<storage::ParameterDescriptor> handwritten_descriptors(std::string_view spacecraft) {
  return reference::descriptors_of(std::span<const reference::PointInfo>(rates()), spacecraft);
}

}  // namespace reident::satcs::platform
