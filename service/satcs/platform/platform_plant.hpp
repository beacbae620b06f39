// The plant of the platform family: thermal nodes with heaters, reaction wheels that turn the
// spacecraft, and a transmitter. PLATFORM.md describes it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "service/satcs/platform/attitude_loop.hpp"
#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/platform/reaction_wheel.hpp"
#include "service/satcs/platform/sunlight.hpp"
#include "service/satcs/platform/thermal_network.hpp"
#include "service/satcs/platform/transmitter.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "service/satcs/reference/reference_loads.hpp"
#include "service/satcs/reference/reference_orbit.hpp"

namespace reident::satcs::platform {

/// Where heat came from and went to in one step [W]; what is stored is the difference.
struct HeatBalance {
  double absorbed = 0;  // from the Sun and the Earth
  double electronics = 0;
  double heaters = 0;
  double wheels = 0;
  double amplifier = 0;
  double emitted = 0;

  double stored() const { return absorbed + electronics + heaters + wheels + amplifier - emitted; }
};

class PlatformPlant {
 public:
  static constexpr int usual_steps_per_second = 4;
  /// Orbits that have been simulated before the start, so that the deck and the panels have
  /// forgotten their first temperatures.
  static constexpr int warm_up_orbits = 8;

  /// At `start`, a multiple of a second. `fresh` are the constants before any event of `life`.
  PlatformPlant(const Constants& fresh, std::vector<reference::LifeEvent> life, storage::Time start,
                std::uint64_t seed, int steps_per_second = usual_steps_per_second);

  void step();
  int steps_per_second() const { return steps_per_second_; }
  double step_s() const { return step_s_; }
  storage::Time time() const;

  const ThermalNetwork& thermal() const { return thermal_; }
  const ReactionWheel& wheel(std::size_t k) const { return wheels_[k]; }
  const AttitudeLoop& axis(std::size_t k) const { return axes_[k]; }
  const Transmitter& transmitter() const { return transmitter_; }
  const Sunlight& sunlight() const { return sunlight_; }
  const reference::OperationsPlan::On& on() const { return on_; }
  /// As aged as they are now.
  const Constants& constants() const { return constants_; }

  double command_Nm(std::size_t axis) const { return command_Nm_[axis]; }
  double bus_V() const { return bus_V_; }
  double electronics_A() const { return electronics_W_ / bus_V_; }
  double heater_A(std::size_t heater) const { return heater_W_[heater] / bus_V_; }
  /// Whether its thermostat has switched the heater on.
  bool heater_on(std::size_t heater) const { return heater_on_[heater]; }
  double sun_sensor_mA(std::size_t panel) const;
  /// The balance of the last step.
  HeatBalance heat_balance() const { return balance_; }

 private:
  void begin_second();
  void age();
  void supply();
  void turn();
  NodeValues heat();

  int steps_per_second_;
  double step_s_;
  Constants fresh_;
  std::vector<reference::LifeEvent> life_;
  Constants constants_;  // of the running second
  reference::Orbit orbit_;
  reference::OperationsPlan plan_;
  SlewPlan slews_;
  DrivePlan drives_;
  ThermalNetwork thermal_;
  std::array<ReactionWheel, wheel_count> wheels_;
  std::array<AttitudeLoop, wheel_count> axes_;
  Transmitter transmitter_;
  RandomStream random_;
  reference::SlowVariation bus_variation_, electronics_variation_;

  storage::Time second_;  // the running second began here
  int step_in_second_ = 0;
  Sunlight sunlight_;  // of the running second, as all that follows
  reference::OperationsPlan::On on_;
  PanelValues absorbed_W_{};
  std::array<double, wheel_count> disturbance_Nm_{}, slew_rad_s2_{};
  double drive_mW_ = 0;
  std::array<bool, heater_count> heater_on_{};

  std::array<double, wheel_count> command_Nm_{};  // of the last step, as all that follows
  std::array<double, heater_count> heater_W_{};
  double bus_V_ = 28;
  double electronics_W_ = 0;
  double load_W_ = 0;
  HeatBalance balance_;
};

}  // namespace reident::satcs::platform
