// The attitude loop of one axis, whose torque command is the wheel's input, and what it works
// against: disturbance torques, slews, and the unloading of momentum.
//
//   body:     J_b d2e/dt2 = external - net - J_b a_ref         e: attitude error, a_ref: the slew's
//   command:  K_p e + K_d de/dt + K_i integral of e - J_b a_ref
//
// The integral learns the wheel's friction, so that the command has it in it.
#pragma once

#include <cstdint>
#include <vector>

#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/platform/sunlight.hpp"
#include "service/satcs/reference/random.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "service/satcs/reference/reference_orbit.hpp"

namespace reident::satcs::platform {

/// When the spacecraft turns: a function of time, seed and modes alone.
class SlewPlan {
 public:
  /// There are no slews in the safe and quiet modes of `life`; the other events do not count.
  SlewPlan(const reference::Orbit& orbit, const SlewConstants& constants,
           std::vector<reference::LifeEvent> life, std::uint64_t seed);

  /// Angular acceleration about an axis [rad/s2], whose slews are `slew_deg` at most: half of a
  /// ramp speeds up, the other half slows down.
  double acceleration(std::size_t axis, double slew_deg, storage::Time time) const;

 private:
  reference::Orbit orbit_;
  SlewConstants constants_;
  std::vector<reference::LifeEvent> life_;
  std::uint64_t seed_;
};

/// What the environment turns the body with [Nm].
double disturbance_Nm(const AxisConstants& axis, double orbit_phase, const Sunlight& sunlight);

class AttitudeLoop {
 public:
  AttitudeLoop(const AxisConstants& constants, double step_s, std::uint64_t seed,
               std::uint64_t stream);

  /// Once a second: whether momentum is unloaded, and the noise of the rate sensor.
  void update(double wheel_rad_s);
  /// The torque that the wheel is to give now.
  double command_Nm(double slew_rad_s2) const;
  /// One step, in which the wheel took `net_Nm` up.
  void step(double external_Nm, double net_Nm, double slew_rad_s2);

  /// What unloading adds to the external torque.
  double unloading_Nm() const { return unloading_Nm_; }
  double error_rad() const { return error_rad_; }

 private:
  AxisConstants constants_;
  double step_s_;
  RandomStream random_;
  double error_rad_ = 0, rate_rad_s_ = 0, integral_rads_ = 0;
  double noise_rad_s_ = 0;
  double unloading_Nm_ = 0;
};

}  // namespace reident::satcs::platform
