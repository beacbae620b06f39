#include "service/satcs/reference_spacecraft.hpp"

#include <array>
#include <chrono>
#include <utility>

#include "service/satcs/parameter_id.hpp"

namespace reident::satcs::reference {
namespace {

constexpr auto analog = storage::ParameterKind::analog;
constexpr auto digital = storage::ParameterKind::digital;

// Sensors. The three currents that meet at the bus have the same one, so that their readings add up
// but for noise and quantum.
constexpr SensorSpec bus_current{0.8, 0.04, 0, 80, 12};
constexpr SensorSpec input_current{1.6, 0.03, 0, 30, 12};
constexpr SensorSpec battery_current{1.2, 0.03, -40, 20, 12};
constexpr SensorSpec section_current{1.0, 0.01, 0, 10, 12};
constexpr SensorSpec bus_voltage{0.4, 0.004, 20, 36, 12};
constexpr SensorSpec battery_voltage{0.8, 0.01, 30, 65, 12};
constexpr SensorSpec amplifier_voltage{0.4, 0.01, 0, 15, 12};
constexpr SensorSpec temperature{5, 0.05, -40, 80, 12};
constexpr SensorSpec array_temperature{5, 0.1, -120, 120, 12};

using P = const Plant&;

constexpr std::array points = {
    TelemetryPoint{"I_BDRIN1", "A", "Discharge regulator, input current from battery 1", analog,
                   [](P p) { return p.flows().bdr_in_A[0]; }, input_current},
    TelemetryPoint{"I_BDRIN2", "A", "Discharge regulator, input current from battery 2", analog,
                   [](P p) { return p.flows().bdr_in_A[1]; }, input_current},
    TelemetryPoint{"I_BDROUT", "A", "Discharge regulator, output current", analog,
                   [](P p) { return p.flows().bdr_out_A; }, bus_current},
    TelemetryPoint{"I_BAT1", "A", "Battery 1, current, positive when it charges", analog,
                   [](P p) { return p.flows().battery_A[0]; }, battery_current},
    TelemetryPoint{"I_BAT2", "A", "Battery 2, current, positive when it charges", analog,
                   [](P p) { return p.flows().battery_A[1]; }, battery_current},
    TelemetryPoint{"I_SAG1A", "A", "Solar array section 1A, current", analog,
                   [](P p) { return p.flows().section_A[0]; }, section_current},
    TelemetryPoint{"I_SAG1B", "A", "Solar array section 1B, current", analog,
                   [](P p) { return p.flows().section_A[1]; }, section_current},
    TelemetryPoint{"I_SGBCHC", "A", "Charge controller 1, current to battery 1", analog,
                   [](P p) { return p.flows().charge_A[0]; }, section_current},
    TelemetryPoint{"I_SGBCHC2", "A", "Charge controller 2, current to battery 2", analog,
                   [](P p) { return p.flows().charge_A[1]; }, section_current},
    TelemetryPoint{"I_SG2", "A", "Solar array section 2, current to the bus", analog,
                   [](P p) { return p.flows().sg2_A; }, bus_current},
    TelemetryPoint{"I_SHUNT", "A", "Shunt, current of all channels", analog,
                   [](P p) { return p.flows().shunt_A; }, bus_current},
    TelemetryPoint{"I_BUS", "A", "Main bus, current", analog, [](P p) { return p.flows().bus_A; },
                   bus_current},
    TelemetryPoint{"V_BUS", "V", "Main bus, voltage", analog, [](P p) { return p.flows().bus_V; },
                   bus_voltage},
    TelemetryPoint{"V_BAT1", "V", "Battery 1, voltage", analog,
                   [](P p) { return p.flows().battery_V[0]; }, battery_voltage},
    TelemetryPoint{"V_BAT2", "V", "Battery 2, voltage", analog,
                   [](P p) { return p.flows().battery_V[1]; }, battery_voltage},
    TelemetryPoint{"V_MEA", "V", "Main error amplifier, output voltage", analog,
                   [](P p) { return p.flows().mea_V; }, amplifier_voltage},
    TelemetryPoint{"T_BAT1", "degC", "Battery 1, temperature", analog,
                   [](P p) { return p.battery(0).state().temperature_C; }, temperature},
    TelemetryPoint{"T_BAT2", "degC", "Battery 2, temperature", analog,
                   [](P p) { return p.battery(1).state().temperature_C; }, temperature},
    TelemetryPoint{"T_BDR", "degC", "Discharge regulator, temperature", analog,
                   [](P p) { return p.bdr().temperature_C(); }, temperature},
    TelemetryPoint{"T_SAG", "degC", "Solar array, temperature", analog,
                   [](P p) { return p.array().temperature_C(); }, array_temperature},
    TelemetryPoint{"S_PAYLOAD",
                   "",
                   "Cameras on",
                   digital,
                   [](P p) { return p.loads().on().payload ? 1.0 : 0.0; },
                   {}},
    TelemetryPoint{"S_TX",
                   "",
                   "Transmitter on",
                   digital,
                   [](P p) { return p.loads().on().transmitter ? 1.0 : 0.0; },
                   {}},
    TelemetryPoint{"S_BHC1",
                   "",
                   "Heater of battery 1 on",
                   digital,
                   [](P p) { return p.loads().heater_on(0) ? 1.0 : 0.0; },
                   {}},
    TelemetryPoint{"S_BHC2",
                   "",
                   "Heater of battery 2 on",
                   digital,
                   [](P p) { return p.loads().heater_on(1) ? 1.0 : 0.0; },
                   {}},
};

}  // namespace

storage::Time whole_seconds(storage::Time time) {
  using namespace std::chrono;
  return nanoseconds(floor<seconds>(nanoseconds(time))).count();
}

std::span<const TelemetryPoint> telemetry_points() {
  return points;
}

std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft) {
  std::vector<storage::ParameterDescriptor> descriptors;
  for (const TelemetryPoint& point : points) {
    storage::ParameterDescriptor d;
    d.spacecraft = spacecraft;
    d.id = parameter_id(point.name);
    d.name = point.name;
    d.unit = point.unit;
    d.description = point.description;
    d.kind = point.kind;
    if (point.kind == analog) {
      d.low_limit = point.sensor.low;
      d.high_limit = point.sensor.high;
    }
    descriptors.push_back(std::move(d));
  }
  return descriptors;
}

Spacecraft::Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
                       std::uint64_t seed)
    : plant_(fresh, std::move(life), whole_seconds(start), seed) {
  for (const TelemetryPoint& point : points) {
    if (point.kind == digital) continue;
    sensors_.emplace_back(point.sensor, Plant::step_s, seed, parameter_id(point.name));
  }
  observe();
}

void Spacecraft::read(std::vector<storage::Sample>& samples) {
  samples.clear();
  std::size_t sensor = 0;
  for (const TelemetryPoint& point : points) {
    const double value = point.kind == digital ? point.read(plant_) : sensors_[sensor++].read();
    samples.push_back({parameter_id(point.name), storage::Quality::good, value});
  }
}

std::vector<double> Spacecraft::noise_free() const {
  std::vector<double> values;
  std::size_t sensor = 0;
  for (const TelemetryPoint& point : points) {
    values.push_back(point.kind == digital ? point.read(plant_) : sensors_[sensor++].filtered());
  }
  return values;
}

void Spacecraft::advance() {
  for (int step = 0; step < Plant::steps_per_second; ++step) {
    plant_.step();
    observe();
  }
}

void Spacecraft::observe() {
  std::size_t sensor = 0;
  for (const TelemetryPoint& point : points) {
    if (point.kind == analog) sensors_[sensor++].observe(point.read(plant_));
  }
}

}  // namespace reident::satcs::reference
