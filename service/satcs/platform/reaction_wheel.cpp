#include "service/satcs/platform/reaction_wheel.hpp"

#include <algorithm>
#include <cmath>

namespace reident::satcs::platform {
namespace {

constexpr double turning_rad_s = 0.5;  // below which the Coulomb friction fades out
constexpr double bearing_rated_C = 20;

}  // namespace

ReactionWheel::ReactionWheel(const WheelConstants& constants, double speed_rad_s, double step_s,
                             std::uint64_t seed, std::uint64_t stream)
    : constants_(constants),
      step_s_(step_s),
      random_(seed, stream),
      ripple_(constants.ripple, constants.ripple_correlation_s),
      speed_rad_s_(speed_rad_s) {}

double ReactionWheel::friction_Nm(double speed_rad_s, double temperature_C) const {
  const WheelConstants& c = constants_;
  const double rest = speed_rad_s / c.stribeck_rad_s;
  const double dry = std::tanh(speed_rad_s / turning_rad_s) *
                     (c.coulomb_Nm + c.stribeck_Nm * std::exp(-rest * rest));
  const double viscous =
      c.viscous_Nms * std::exp(c.viscous_per_K * (temperature_C - bearing_rated_C));
  return (1 + ripple_.value()) * (dry + viscous * speed_rad_s);
}

void ReactionWheel::step(double command_Nm, double bus_V, double temperature_C) {
  const WheelConstants& c = constants_;
  // The command is turned into a current by the constant of a new motor.
  const double wanted_A =
      std::clamp(command_Nm / WheelConstants{}.torque_Nm_A, -c.current_max_A, c.current_max_A);
  const double own_V = c.torque_Nm_A * speed_rad_s_;
  const double least_A = (-bus_V - own_V) / c.winding_ohm, most_A = (bus_V - own_V) / c.winding_ohm;
  const double followed_A =
      wanted_A + (motor_A_ - wanted_A) * std::exp(-step_s_ / c.current_loop_s);
  motor_A_ = std::clamp(followed_A, least_A, most_A);

  const double motor_Nm = c.torque_Nm_A * motor_A_;
  net_Nm_ = motor_Nm - friction_Nm(speed_rad_s_, temperature_C);
  const double before_J = kinetic_J();
  const double speed_before = speed_rad_s_;
  speed_rad_s_ += step_s_ * net_Nm_ / c.inertia_kg_m2;
  const double electrical_W =
      motor_Nm * (speed_before + speed_rad_s_) / 2 + c.winding_ohm * motor_A_ * motor_A_;
  supply_W_ = c.drive_W + std::max(electrical_W, 0.0);
  heat_W_ = supply_W_ - (kinetic_J() - before_J) / step_s_;
}

}  // namespace reident::satcs::platform
