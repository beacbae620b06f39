// The simulator's own model of the platform, as a project writes it before launch from data sheets
// and the thermal budget. It is tuned to nothing that the spacecraft has sent.
//
//   C dT/dt = Q - G (T - T_sink)     each node by itself, against a sink of the thermal budget
//   J dw/dt = T_cmd - b w            T_cmd: what slews and gravity ask for, plus b w
//   P_out = g D,  P_supply = P_q + P_out / efficiency
//
// The orbit, the slews, the drive levels and the operations plan are the spacecraft's own:
// operators know them. There is no radiation law, no thermostat (heaters run at half of their
// power), no dry friction, no temperature in any unit, no noise and no sensor (PLATFORM.md).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "service/satcs/platform/attitude_loop.hpp"
#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/platform/sunlight.hpp"
#include "service/satcs/platform/transmitter.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::platform {

struct HandwrittenPlatformConstants {
  double bus_V = 28;
  double electronics_W = 180, payload_W = 100, safe_W = 120;
  double heater_duty = 0.5;
  double wheel_viscous_Nms = 4e-5;
  double wheel_idle_W = 4;
  double wheel_efficiency = 0.8;
  double gain = 4500;  // 36.5 dB
  double quiescent_W = 8;
  double efficiency = 0.45;
  double gravity_Nm = 1e-3;  // amplitude, once an orbit, on each axis: the one disturbance
  double panel_capacity_J_K = 8000, panel_W_K = 4;
  std::array<double, panel_count> panel_sink_C{-25, 0, -18, -22};
  double panel_absorptance = 0.2, panel_area_m2 = 0.7;
  /// Temperatures at which the thermal budget has the heated nodes and the bearings.
  std::array<double, heater_count> heated_C{16, 14, 5, 13};
  double bearing_C = 20;
  double amplifier_J_K = 1000, amplifier_W_K = 4;
};

class HandwrittenPlatform {
 public:
  /// From `start`, rounded down to a second, with the plans of `seed` and the modes of `life`.
  HandwrittenPlatform(const Constants& spacecraft, std::vector<reference::LifeEvent> life,
                      storage::Time start, std::uint64_t seed);

  storage::Time time() const { return time_; }
  /// A sample for each of handwritten_descriptors() that is due now, as on the spacecraft.
  void read(std::vector<storage::Sample>& samples) const;
  /// Goes on by one second.
  void advance();

  struct State {
    std::array<double, panel_count> panel_C{};
    std::array<double, heater_count> heated_C{};
    std::array<double, wheel_count> command_Nm{}, speed_rad_s{}, motor_A{}, supply_A{};
    std::array<double, heater_count> heater_A{};
    std::array<double, panel_count> sun_mA{};
    double bearing_C = 0, amplifier_C = 0;
    double electronics_A = 0, bus_V = 0;
    double drive_mW = 0, output_W = 0, amplifier_A = 0;
    bool safe_mode = false;
  };
  const State& state() const { return state_; }

 private:
  void solve();

  HandwrittenPlatformConstants constants_;
  Constants spacecraft_;
  reference::Orbit orbit_;
  reference::OperationsPlan plan_;
  SlewPlan slews_;
  DrivePlan drives_;
  storage::Time time_;
  std::array<bool, wheel_count> unloads_{};
  State state_;
};

/// Describes the telemetry points that the model has, in the order of its samples, as the
/// spacecraft's points of the same names.
std::vector<storage::ParameterDescriptor> handwritten_descriptors(std::string_view spacecraft);

}  // namespace reident::satcs::platform
