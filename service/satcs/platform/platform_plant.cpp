#include "service/satcs/platform/platform_plant.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "service/satcs/platform/platform_life.hpp"

namespace reident::satcs::platform {
namespace {

constexpr double rated_V = 28;
// Random streams of the plant; sensors have the ids of their parameters.
constexpr std::uint64_t supply_stream = 1, wheel_stream = 10, axis_stream = 20;

storage::Time warm_up_ns(const Constants& constants) {
  return PlatformPlant::warm_up_orbits *
         static_cast<storage::Time>(std::ceil(constants.orbit.period_s)) * storage::second_ns;
}

double total(const auto& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

template <std::size_t... k>
std::array<ReactionWheel, wheel_count> wheels_of(const Constants& c, double step_s,
                                                 std::uint64_t seed, std::index_sequence<k...>) {
  return {ReactionWheel(c.wheel[k], c.axis[k].bias_rad_s, step_s, seed, wheel_stream + k)...};
}

template <std::size_t... k>
std::array<AttitudeLoop, wheel_count> axes_of(const Constants& c, double step_s, std::uint64_t seed,
                                              std::index_sequence<k...>) {
  return {AttitudeLoop(c.axis[k], step_s, seed, axis_stream + k)...};
}

constexpr std::make_index_sequence<wheel_count> each_wheel;

}  // namespace

PlatformPlant::PlatformPlant(const Constants& fresh, std::vector<reference::LifeEvent> life,
                             storage::Time start, std::uint64_t seed, int steps_per_second)
    : steps_per_second_(steps_per_second),
      step_s_(1.0 / steps_per_second),
      fresh_(fresh),
      life_(std::move(life)),
      constants_(aged(fresh_, life_, start - warm_up_ns(fresh))),
      orbit_(constants_.orbit),
      plan_(orbit_, constants_.plan, life_, seed),
      slews_(orbit_, constants_.slew, life_, seed),
      drives_(orbit_, constants_, life_, seed),
      thermal_(constants_.thermal, step_s_),
      wheels_(wheels_of(constants_, step_s_, seed, each_wheel)),
      axes_(axes_of(constants_, step_s_, seed, each_wheel)),
      transmitter_(constants_.transmitter, step_s_),
      random_(seed, supply_stream),
      bus_variation_(constants_.supply.sigma_V, constants_.supply.correlation_s),
      electronics_variation_(constants_.supply.electronics_sigma_W,
                             constants_.supply.electronics_correlation_s),
      second_(start - warm_up_ns(fresh)) {
  while (time() < start) step();
}

storage::Time PlatformPlant::time() const {
  return second_ + step_in_second_ * storage::second_ns / steps_per_second_;
}

double PlatformPlant::sun_sensor_mA(std::size_t panel) const {
  const double reflected = constants_.thermal.panel[panel].earth_view * sunlight_.reflected;
  return constants_.environment.sun_sensor_mA * (sunlight_.direct[panel] + reflected);
}

void PlatformPlant::step() {
  if (step_in_second_ == 0) begin_second();
  supply();
  turn();
  transmitter_.step(drive_mW_, thermal_.temperature_C(amplifier_case));
  thermal_.step(heat());
  balance_.emitted = thermal_.emitted_W();
  if (++step_in_second_ == steps_per_second_) {
    step_in_second_ = 0;
    second_ += storage::second_ns;
  }
}

void PlatformPlant::begin_second() {
  if (reference::ages_between(life_, second_ - storage::second_ns, second_)) age();
  sunlight_ = sunlight_at(orbit_, constants_.environment, second_);
  absorbed_W_ = absorbed_W(sunlight_, constants_.environment, constants_.thermal);
  on_ = plan_.at(second_);
  drive_mW_ = drives_.drive_mW(second_);
  bus_variation_.advance(random_);
  electronics_variation_.advance(random_);
  const double phase = orbit_.count(second_).phase;
  for (std::size_t k = 0; k < wheel_count; ++k) {
    disturbance_Nm_[k] = disturbance_Nm(constants_.axis[k], phase, sunlight_);
    slew_rad_s2_[k] = slews_.acceleration(k, constants_.axis[k].slew_deg, second_);
    wheels_[k].vary();
    axes_[k].update(wheels_[k].speed_rad_s());
  }
  for (std::size_t h = 0; h < heater_count; ++h) {
    const HeaterConstants& heater = constants_.thermal.heater[h];
    heater_on_[h] = reference::thermostat(heater_on_[h], thermal_.temperature_C(first_heated + h),
                                          heater.thermostat[heater.in_use]);
  }
}

void PlatformPlant::age() {
  constants_ = aged(fresh_, life_, second_);
  thermal_.age(constants_.thermal);
  for (std::size_t k = 0; k < wheel_count; ++k) wheels_[k].age(constants_.wheel[k]);
  transmitter_.age(constants_.transmitter);
}

/// The bus's voltage follows from the loads of the step before; heaters are resistors.
void PlatformPlant::supply() {
  const SupplyConstants& c = constants_.supply;
  bus_V_ = c.bus_V + c.sunlit_V * sunlight_.illumination + bus_variation_.value() -
           c.source_ohm * load_W_ / rated_V;
  electronics_W_ = (on_.safe_mode ? c.safe_W : c.electronics_W) +
                   (on_.payload ? c.payload_W : 0.0) + electronics_variation_.value();
  for (std::size_t h = 0; h < heater_count; ++h) {
    const HeaterConstants& heater = constants_.thermal.heater[h];
    const double whole_W = heater.share * heater.rated_W * bus_V_ * bus_V_ / (rated_V * rated_V);
    heater_W_[h] = whole_W * (heater_on_[h] ? 1.0 : heater.stuck_share);
  }
}

void PlatformPlant::turn() {
  for (std::size_t k = 0; k < wheel_count; ++k) {
    command_Nm_[k] = axes_[k].command_Nm(slew_rad_s2_[k]);
    wheels_[k].step(command_Nm_[k], bus_V_, thermal_.temperature_C(wheel_1 + k));
    axes_[k].step(disturbance_Nm_[k] + axes_[k].unloading_Nm(), wheels_[k].net_Nm(),
                  slew_rad_s2_[k]);
  }
}

NodeValues PlatformPlant::heat() {
  NodeValues heat_W{};
  for (std::size_t p = 0; p < panel_count; ++p) heat_W[p] = absorbed_W_[p];
  for (std::size_t h = 0; h < heater_count; ++h) heat_W[first_heated + h] = heater_W_[h];
  heat_W[deck] += electronics_W_;
  double wheels_W = 0, wheels_supply_W = 0;
  for (std::size_t k = 0; k < wheel_count; ++k) {
    heat_W[wheel_1 + k] = wheels_[k].heat_W();
    wheels_W += wheels_[k].heat_W();
    wheels_supply_W += wheels_[k].supply_W();
  }
  heat_W[amplifier_case] = transmitter_.heat_W();
  load_W_ = electronics_W_ + total(heater_W_) + wheels_supply_W + transmitter_.supply_W();
  balance_ = {total(absorbed_W_), electronics_W_,        total(heater_W_),
              wheels_W,           transmitter_.heat_W(), 0};
  return heat_W;
}

}  // namespace reident::satcs::platform
