// A reaction wheel: a motor whose current follows a torque command, and a rotor with friction.
//
//   J dw/dt = k_t I - friction(w, T)
//   friction = tanh(w / w_0) (T_c + T_s exp(-(w / w_s)^2)) + b(T) w,   b(T) = b exp(c (T - 20
//   degC))
//
// The current is limited, and so is the voltage that drives it against the rotor's own. The drive
// gives nothing back to the bus: what braking frees becomes heat.
#pragma once

#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/reference/random.hpp"
#include "service/satcs/reference/reference_loads.hpp"

namespace reident::satcs::platform {

class ReactionWheel {
 public:
  ReactionWheel(const WheelConstants& constants, double speed_rad_s, double step_s,
                std::uint64_t seed, std::uint64_t stream);
  void age(const WheelConstants& constants) { constants_ = constants; }

  /// Once a second: the slow variation of the friction.
  void vary() { ripple_.advance(random_); }
  void step(double command_Nm, double bus_V, double temperature_C);

  double speed_rad_s() const { return speed_rad_s_; }
  double motor_A() const { return motor_A_; }
  /// What the drive takes from the bus.
  double supply_W() const { return supply_W_; }
  /// What the last step left as heat: all that was taken and is not in the rotor.
  double heat_W() const { return heat_W_; }
  /// What the rotor got in the last step, and the attitude loop counts on.
  double net_Nm() const { return net_Nm_; }
  double kinetic_J() const { return constants_.inertia_kg_m2 * speed_rad_s_ * speed_rad_s_ / 2; }
  double friction_Nm(double speed_rad_s, double temperature_C) const;

 private:
  WheelConstants constants_;
  double step_s_;
  RandomStream random_;
  reference::SlowVariation ripple_;
  double speed_rad_s_;
  double motor_A_ = 0;
  double supply_W_ = 0, heat_W_ = 0, net_Nm_ = 0;
};

}  // namespace reident::satcs::platform
