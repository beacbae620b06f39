#include "service/satcs/reference/reference_loads.hpp"

#include <cmath>
#include <utility>

namespace reident::satcs::reference {
namespace {

constexpr double rated_heater_V = 28;

SlowVariation variation_of(const LineConstants& line) {
  return {line.sigma_A, line.correlation_s};
}

}  // namespace

bool thermostat(bool on, double temperature_C, const ThermostatConstants& limits) {
  if (temperature_C < limits.on_C) return true;
  return on && temperature_C < limits.off_C;
}

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
    : plan_(orbit, constants, life, seed),
      constants_(constants),
      random_(seed, 0),
      platform_variation_(constants.platform_sigma_W, constants.platform_correlation_s),
      line_variation_{variation_of(constants.line[0]), variation_of(constants.line[1]),
                      variation_of(constants.line[2])} {}

void Loads::update(storage::Time time, double illumination,
                   const std::array<double, battery_count>& battery_C) {
  const LoadConstants& c = constants_;
  on_ = plan_.at(time);
  platform_variation_.advance(random_);
  for (std::size_t l = 0; l < converter_count; ++l) {
    const LineConstants& line = c.line[l];
    line_variation_[l].advance(random_);
    line_A_[l] = line.base_A + (on_.payload ? line.payload_A : 0.0) +
                 (on_.transmitter ? line.transmitter_A : 0.0) + line_variation_[l].value();
  }
  if (on_.safe_mode) line_A_[camera_line] = 0;

  for (std::size_t k = 0; k < battery_count; ++k) {
    battery_heater_on_[k] =
        thermostat(battery_heater_on_[k], battery_C[k], c.battery_heater[c.heater_in_use[k]]);
  }
  const double sink_C = c.equipment_sink_C + c.equipment_sun_K * illumination;
  const double heat_W = (equipment_heater_on_ ? c.equipment_heater_W : 0.0) -
                        c.equipment_conductance_W_K * (equipment_C_ - sink_C);
  equipment_C_ += heat_W / c.equipment_capacity_J_K;
  equipment_heater_on_ = thermostat(equipment_heater_on_, equipment_C_, c.equipment_heater);
}

Loads::Currents Loads::currents_A(double distributor_V,
                                  const std::array<double, converter_count>& converter_W) const {
  const LoadConstants& c = constants_;
  const auto heater = [&](bool on, double power_W) {
    return on ? power_W * distributor_V / (rated_heater_V * rated_heater_V) : 0.0;
  };
  Currents currents{};
  currents[platform] =
      ((on_.safe_mode ? c.platform_safe_W : c.platform_W) + platform_variation_.value()) /
      distributor_V;
  currents[transmitter] = on_.transmitter ? c.transmitter_W / distributor_V : 0;
  currents[equipment_heater] = heater(equipment_heater_on_, c.equipment_heater_W);
  for (std::size_t k = 0; k < battery_count; ++k) {
    currents[battery_heater_1 + k] = heater(battery_heater_on_[k], c.battery_heater_W);
  }
  for (std::size_t l = 0; l < converter_count; ++l) {
    currents[converter_1 + l] = converter_W[l] / distributor_V;
  }
  return currents;
}

}  // namespace reident::satcs::reference
