#include "service/satcs/platform/attitude_loop.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace reident::satcs::platform {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;

}  // namespace

SlewPlan::SlewPlan(const reference::Orbit& orbit, const SlewConstants& constants,
                   std::vector<reference::LifeEvent> life, std::uint64_t seed)
    : orbit_(orbit), constants_(constants), life_(std::move(life)), seed_(mix(mix(seed))) {}

double SlewPlan::acceleration(std::size_t axis, double slew_deg, storage::Time time) const {
  using reference::LifeKind;
  if (reference::in_mode(life_, LifeKind::safe_mode, time) ||
      reference::in_mode(life_, LifeKind::quiet, time))
    return 0;
  const SlewConstants& c = constants_;
  const auto count = orbit_.count(time);
  const double slots = count.phase * c.slots;
  const double slot = std::floor(slots);
  const auto number =
      static_cast<std::uint64_t>(count.number * c.slots) + static_cast<std::uint64_t>(slot);
  const std::uint64_t bits = mix(seed_ ^ mix(number * wheel_count + axis));
  if (unit_interval(bits) >= c.probability) return 0;
  const double slot_s = orbit_.period_s() / c.slots;
  const double hold_s = c.hold_min_s + (c.hold_max_s - c.hold_min_s) * unit_interval(mix(bits + 1));
  const double spare_s = slot_s - 2 * c.ramp_s - hold_s;
  const double begin_s = spare_s * unit_interval(mix(bits + 2));
  const double angle = slew_deg * degree * (2 * unit_interval(mix(bits + 3)) - 1);
  const double acceleration = 4 * angle / (c.ramp_s * c.ramp_s);
  const double since_s = (slots - slot) * slot_s - begin_s;
  const double back_s = since_s - c.ramp_s - hold_s;
  if (since_s >= 0 && since_s < c.ramp_s)
    return since_s < c.ramp_s / 2 ? acceleration : -acceleration;
  if (back_s >= 0 && back_s < c.ramp_s) return back_s < c.ramp_s / 2 ? -acceleration : acceleration;
  return 0;
}

double disturbance_Nm(const AxisConstants& axis, double orbit_phase, const Sunlight& sunlight) {
  const double angle = 2 * pi * orbit_phase;
  return axis.secular_Nm + axis.orbital_Nm * std::cos(angle) + axis.twice_Nm * std::sin(2 * angle) +
         axis.pressure_Nm * sunlight.flux;
}

AttitudeLoop::AttitudeLoop(const AxisConstants& constants, double step_s, std::uint64_t seed,
                           std::uint64_t stream)
    : constants_(constants), step_s_(step_s), random_(seed, stream) {}

void AttitudeLoop::update(double wheel_rad_s) {
  const AxisConstants& c = constants_;
  noise_rad_s_ = c.rate_noise_rad_s * random_.gaussian();
  const double off = wheel_rad_s - c.bias_rad_s;
  if (std::abs(off) > c.unload_from_rad_s) unloading_Nm_ = std::copysign(c.unload_Nm, -off);
  // It ends near the bias speed, or beyond it.
  if (unloading_Nm_ != 0 && off * unloading_Nm_ > -c.unload_until_rad_s * c.unload_Nm)
    unloading_Nm_ = 0;
}

double AttitudeLoop::command_Nm(double slew_rad_s2) const {
  const AxisConstants& c = constants_;
  const double w = c.bandwidth_rad_s;
  return c.body_kg_m2 * (w * w * error_rad_ + 2 * w * (rate_rad_s_ + noise_rad_s_) +
                         c.integral_share * w * w * w * integral_rads_ - slew_rad_s2);
}

void AttitudeLoop::step(double external_Nm, double net_Nm, double slew_rad_s2) {
  const double turning = (external_Nm - net_Nm) / constants_.body_kg_m2 - slew_rad_s2;
  rate_rad_s_ += step_s_ * turning;
  error_rad_ += step_s_ * rate_rad_s_;
  integral_rads_ += step_s_ * error_rad_;
}

}  // namespace reident::satcs::platform
