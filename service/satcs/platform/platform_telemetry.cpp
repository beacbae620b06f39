#include "service/satcs/platform/platform_telemetry.hpp"

#include <array>

namespace reident::satcs::platform {
namespace {

using reference::Rate;
using reference::SensorSpec;

// The computer sets the torque command, which has no noise.
constexpr SensorSpec torque_word{0.25, 0, -0.2, 0.2, 16};
constexpr SensorSpec wheel_speed{1.0, 0.05, -450, 450, 16};
constexpr SensorSpec motor_current{0.8, 0.004, -3, 3, 12};
constexpr SensorSpec wheel_current{0.8, 0.004, 0, 5, 12};
constexpr SensorSpec heater_current{0.8, 0.004, 0, 4, 12};
constexpr SensorSpec electronics_current{0.8, 0.01, 0, 15, 12};
constexpr SensorSpec bus_voltage{0.4, 0.006, 20, 36, 12};
constexpr SensorSpec sun_sensor{0.5, 0.01, 0, 12, 12};
constexpr SensorSpec drive_word{0.25, 0, 0, 16, 12};
constexpr SensorSpec output_power{0.5, 0.08, 0, 60, 12};
constexpr SensorSpec amplifier_current{0.8, 0.008, 0, 6, 12};
constexpr SensorSpec node_temperature{5, 0.05, -60, 90, 12};

using P = const PlatformPlant&;
using Read = double (*)(const PlatformPlant&);

constexpr auto analog = reference::analog_point<PlatformPlant>;
constexpr auto digital = reference::digital_point<PlatformPlant>;

constexpr TelemetryPoint current(std::string_view name, std::string_view description,
                                 const SensorSpec& sensor, Read read) {
  return analog(name, "A", description, reference::every_second, sensor, read);
}

template <std::size_t node>
constexpr TelemetryPoint temperature(std::string_view name, std::string_view description,
                                     Rate rate) {
  return analog(name, "degC", description, rate, node_temperature,
                [](P p) { return p.thermal().temperature_C(node); });
}

double heaters_A(P p) {
  return p.heater_A(0) + p.heater_A(1) + p.heater_A(2) + p.heater_A(3);
}

// Wheels and transmitter, every second.
constexpr std::array fast_points = {
    analog("TQ_RW1", "Nm", "Reaction wheel 1, commanded torque", reference::every_second,
           torque_word, [](P p) { return p.command_Nm(0); }),
    analog("TQ_RW2", "Nm", "Reaction wheel 2, commanded torque", reference::every_second,
           torque_word, [](P p) { return p.command_Nm(1); }),
    analog("TQ_RW3", "Nm", "Reaction wheel 3, commanded torque", reference::every_second,
           torque_word, [](P p) { return p.command_Nm(2); }),
    analog("W_RW1", "rad/s", "Reaction wheel 1, speed", reference::every_second, wheel_speed,
           [](P p) { return p.wheel(0).speed_rad_s(); }),
    analog("W_RW2", "rad/s", "Reaction wheel 2, speed", reference::every_second, wheel_speed,
           [](P p) { return p.wheel(1).speed_rad_s(); }),
    analog("W_RW3", "rad/s", "Reaction wheel 3, speed", reference::every_second, wheel_speed,
           [](P p) { return p.wheel(2).speed_rad_s(); }),
    current("IM_RW1", "Reaction wheel 1, motor current", motor_current,
            [](P p) { return p.wheel(0).motor_A(); }),
    current("IM_RW2", "Reaction wheel 2, motor current", motor_current,
            [](P p) { return p.wheel(1).motor_A(); }),
    current("IM_RW3", "Reaction wheel 3, motor current", motor_current,
            [](P p) { return p.wheel(2).motor_A(); }),
    current("I_RW1", "Reaction wheel 1, supply current of the drive", wheel_current,
            [](P p) { return p.wheel(0).supply_W() / p.bus_V(); }),
    current("I_RW2", "Reaction wheel 2, supply current of the drive", wheel_current,
            [](P p) { return p.wheel(1).supply_W() / p.bus_V(); }),
    current("I_RW3", "Reaction wheel 3, supply current of the drive", wheel_current,
            [](P p) { return p.wheel(2).supply_W() / p.bus_V(); }),
    analog("D_PA", "mW", "Power amplifier, drive level", reference::every_second, drive_word,
           [](P p) { return p.transmitter().drive_mW(); }),
    analog("P_PA", "W", "Power amplifier, output power", reference::every_second, output_power,
           [](P p) { return p.transmitter().output_W(); }),
    current("I_PA", "Power amplifier, supply current", amplifier_current,
            [](P p) { return p.transmitter().supply_W() / p.bus_V(); }),
    current("I_PAD", "Distributor, current to the power amplifier", amplifier_current,
            [](P p) { return p.transmitter().supply_W() / p.bus_V(); }),
    digital("S_PA", "Power amplifier on", reference::every_second,
            [](P p) { return p.transmitter().on() ? 1.0 : 0.0; }),
};

// Supply, heaters and sunlight, every second or every 4 s.
constexpr std::array supply_points = {
    current("I_ELEC", "Electronics of the deck, current", electronics_current,
            [](P p) { return p.electronics_A(); }),
    analog("V_HB", "V", "Heater bus, voltage", reference::every_second, bus_voltage,
           [](P p) { return p.bus_V(); }),
    analog("V_HBB", "V", "Heater bus, voltage, second measurement", Rate{4, 1}, bus_voltage,
           [](P p) { return p.bus_V(); }),
    current("I_H1", "Heater of the deck, current", heater_current,
            [](P p) { return p.heater_A(0); }),
    current("I_H2", "Heater of the wheels' plate, current", heater_current,
            [](P p) { return p.heater_A(1); }),
    current("I_H3", "Heater of the transmitter's plate, current", heater_current,
            [](P p) { return p.heater_A(2); }),
    current("I_H4", "Heater of the tank, current", heater_current,
            [](P p) { return p.heater_A(3); }),
    current("I_HALL", "All heaters, current", electronics_current, heaters_A),
    analog("C_SSZ", "mA", "Sun sensor on the zenith panel, current", Rate{4, 0}, sun_sensor,
           [](P p) { return p.sun_sensor_mA(zenith_panel); }),
    analog("C_SSN", "mA", "Sun sensor on the nadir panel, current", Rate{4, 0}, sun_sensor,
           [](P p) { return p.sun_sensor_mA(nadir_panel); }),
    analog("C_SSS", "mA", "Sun sensor on the panel of the sun side, current", Rate{4, 0},
           sun_sensor, [](P p) { return p.sun_sensor_mA(sun_panel); }),
    digital("S_H1", "Heater of the deck on", Rate{8, 0},
            [](P p) { return p.heater_on(0) ? 1.0 : 0.0; }),
    digital("S_H2", "Heater of the wheels' plate on", Rate{8, 1},
            [](P p) { return p.heater_on(1) ? 1.0 : 0.0; }),
    digital("S_H3", "Heater of the transmitter's plate on", Rate{8, 2},
            [](P p) { return p.heater_on(2) ? 1.0 : 0.0; }),
    digital("S_H4", "Heater of the tank on", Rate{8, 3},
            [](P p) { return p.heater_on(3) ? 1.0 : 0.0; }),
    digital("S_H4R", "Heater of the tank: the redundant thermostat works", Rate{16, 5},
            [](P p) { return p.constants().thermal.heater[3].in_use == 1 ? 1.0 : 0.0; }),
    digital("S_PAR", "The redundant power amplifier works", Rate{16, 9},
            [](P p) { return p.constants().transmitter.in_use == 1 ? 1.0 : 0.0; }),
    digital("S_PSAFE", "Safe mode of the platform", Rate{8, 7},
            [](P p) { return p.on().safe_mode ? 1.0 : 0.0; }),
};

// Temperatures, at once, so that each row of a file at 16 s has them all; second thermistors later.
constexpr std::array temperature_points = {
    temperature<zenith_panel>("T_PZEN", "Zenith panel, temperature", Rate{16, 0}),
    temperature<nadir_panel>("T_PNAD", "Nadir panel, temperature", Rate{16, 0}),
    temperature<sun_panel>("T_PSUN", "Panel of the sun side, temperature", Rate{16, 0}),
    temperature<space_panel>("T_PSPC", "Panel of the space side, temperature", Rate{16, 0}),
    temperature<deck>("T_DECK", "Deck of the electronics, temperature", Rate{16, 0}),
    temperature<wheel_plate>("T_WPL", "Plate of the wheels, temperature", Rate{16, 0}),
    temperature<transmitter_plate>("T_TPL", "Plate of the transmitter, temperature", Rate{16, 0}),
    temperature<tank>("T_TANK", "Tank, temperature", Rate{16, 0}),
    temperature<wheel_1>("T_RW1", "Bearing of wheel 1, temperature", Rate{8, 0}),
    temperature<wheel_2>("T_RW2", "Bearing of wheel 2, temperature", Rate{8, 0}),
    temperature<wheel_3>("T_RW3", "Bearing of wheel 3, temperature", Rate{8, 0}),
    temperature<amplifier_case>("T_PA", "Case of the power amplifier, temperature", Rate{4, 0}),
    temperature<deck>("T_DECKB", "Deck of the electronics, temperature, second thermistor",
                      Rate{32, 9}),
    temperature<wheel_plate>("T_WPLB", "Plate of the wheels, temperature, second thermistor",
                             Rate{32, 13}),
    temperature<transmitter_plate>(
        "T_TPLB", "Plate of the transmitter, temperature, second thermistor", Rate{32, 21}),
    temperature<tank>("T_TANKB", "Tank, temperature, second thermistor", Rate{32, 29}),
};

std::vector<TelemetryPoint> all_points() {
  std::vector<TelemetryPoint> all(fast_points.begin(), fast_points.end());
  all.insert(all.end(), supply_points.begin(), supply_points.end());
  all.insert(all.end(), temperature_points.begin(), temperature_points.end());
  return all;
}

}  // namespace

std::span<const TelemetryPoint> telemetry_points() {
  static const std::vector<TelemetryPoint> points = all_points();
  return points;
}

std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft) {
  return reference::descriptors_of(telemetry_points(), spacecraft);
}

}  // namespace reident::satcs::platform
