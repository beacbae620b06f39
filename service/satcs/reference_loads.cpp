#include "service/satcs/reference_loads.hpp"

#include <cmath>
#include <utility>

namespace reident::satcs::reference {
namespace {

constexpr double rated_heater_V = 28;

bool thermostat(bool on, double temperature_C, double on_C, double off_C) {
  if (temperature_C < on_C) return true;
  return on && temperature_C < off_C;
}

}  // namespace

OperationsPlan::OperationsPlan(const Orbit& orbit, const LoadConstants& constants,
                               std::vector<LifeEvent> life, std::uint64_t seed)
    : orbit_(orbit), constants_(constants), life_(std::move(life)), seed_(mix(seed)) {}

OperationsPlan::On OperationsPlan::at(storage::Time time) const {
  if (in_mode(life_, LifeKind::safe_mode, time)) return {.safe_mode = true};
  if (in_mode(life_, LifeKind::quiet, time)) return {};
  const bool contact = orbit_.in_contact(time);
  const bool sunlit = orbit_.illumination(time) == 1;
  return {.payload = sunlit && (contact || in_session(time)), .transmitter = contact};
}

bool OperationsPlan::in_session(storage::Time time) const {
  // Each orbit, counted from its point farthest from noon so that no session crosses the count,
  // has its own three numbers.
  const auto count = orbit_.count(time);
  const double from_midnight = count.phase - orbit_.noon_phase(time) + 0.5;
  const double whole = std::floor(from_midnight);
  const auto number = static_cast<std::uint64_t>(count.number + static_cast<std::int64_t>(whole));
  const double phase = from_midnight - whole;
  const std::uint64_t bits = mix(seed_ ^ number);
  if (unit_interval(bits) >= constants_.session_probability) return false;
  const double begin = 0.30 + 0.28 * unit_interval(mix(bits));
  const double length_s =
      constants_.session_min_s +
      (constants_.session_max_s - constants_.session_min_s) * unit_interval(mix(mix(bits)));
  return phase >= begin && (phase - begin) * orbit_.period_s() < length_s;
}

Loads::Loads(const Orbit& orbit, const LoadConstants& constants, const std::vector<LifeEvent>& life,
             std::uint64_t seed)
    : plan_(orbit, constants, life, seed), constants_(constants), random_(seed, 0) {}

void Loads::update(storage::Time time, double illumination,
                   const std::array<double, battery_count>& battery_C) {
  const LoadConstants& c = constants_;
  on_ = plan_.at(time);
  // Ornstein and Uhlenbeck's process, exact over one second.
  const double keep = std::exp(-1 / c.platform_correlation_s);
  variation_W_ =
      keep * variation_W_ + c.platform_sigma_W * std::sqrt(1 - keep * keep) * random_.gaussian();
  for (std::size_t k = 0; k < battery_count; ++k) {
    battery_heater_on_[k] = thermostat(battery_heater_on_[k], battery_C[k], c.battery_heater_on_C,
                                       c.battery_heater_off_C);
  }
  const double sink_C = c.equipment_sink_C + c.equipment_sun_K * illumination;
  const double heat_W = (equipment_heater_on_ ? c.equipment_heater_W : 0.0) -
                        c.equipment_conductance_W_K * (equipment_C_ - sink_C);
  equipment_C_ += heat_W / c.equipment_capacity_J_K;
  equipment_heater_on_ = thermostat(equipment_heater_on_, equipment_C_, c.equipment_heater_on_C,
                                    c.equipment_heater_off_C);
}

double Loads::current_A(Load load, double bus_V) const {
  const LoadConstants& c = constants_;
  const auto converter = [&](double power_W) { return power_W / bus_V; };
  const auto heater = [&](bool on, double power_W) {
    return on ? power_W * bus_V / (rated_heater_V * rated_heater_V) : 0.0;
  };
  switch (load) {
    case platform:
      return converter((on_.safe_mode ? c.platform_safe_W : c.platform_W) + variation_W_);
    case payload:
      if (on_.safe_mode) return 0;
      return converter(on_.payload ? c.payload_W : c.payload_standby_W);
    case transmitter:
      return converter(on_.transmitter ? c.transmitter_W : 0.0);
    case equipment_heater:
      return heater(equipment_heater_on_, c.equipment_heater_W);
    case battery_heater_1:
      return heater(battery_heater_on_[0], c.battery_heater_W);
    case battery_heater_2:
      return heater(battery_heater_on_[1], c.battery_heater_W);
    case load_count:
      break;
  }
  return 0;
}

}  // namespace reident::satcs::reference
