#include "service/satcs/reference/reference_telemetry.hpp"

#include <array>

namespace reident::satcs::reference {
namespace {

// Sensors. Currents that meet at the bus or at the distributor have the same time constant, so that
// their readings add up but for noise and quantum.
constexpr SensorSpec bus_current{0.8, 0.04, 0, 80, 12};
constexpr SensorSpec load_current{0.8, 0.015, 0, 30, 12};
constexpr SensorSpec line_current{0.8, 0.015, 0, 30, 12};
constexpr SensorSpec heater_current{0.8, 0.01, 0, 10, 12};
constexpr SensorSpec input_current{1.6, 0.03, 0, 30, 12};
constexpr SensorSpec battery_current{1.2, 0.03, -40, 20, 12};
constexpr SensorSpec section_current{1.0, 0.01, 0, 10, 12};
constexpr SensorSpec bus_voltage{0.4, 0.004, 20, 36, 12};
constexpr SensorSpec battery_voltage{0.8, 0.01, 30, 65, 12};
constexpr SensorSpec line_voltage{0.4, 0.004, 0, 20, 12};
constexpr SensorSpec amplifier_voltage{0.4, 0.01, 0, 15, 12};
constexpr SensorSpec temperature{5, 0.05, -40, 80, 12};
constexpr SensorSpec array_temperature{5, 0.1, -120, 120, 12};

using P = const Plant&;

constexpr auto analog = analog_point<Plant>;
constexpr auto digital = digital_point<Plant>;

double heaters_A(P p) {
  const auto& load_A = p.flows().load_A;
  return load_A[equipment_heater] + load_A[battery_heater_1] + load_A[battery_heater_2];
}

// Generation, storage and regulation, every second.
constexpr std::array power_points = {
    analog("I_BDRIN1", "A", "Discharge regulator, input current from battery 1", every_second,
           input_current, [](P p) { return p.flows().bdr_in_A[0]; }),
    analog("I_BDRIN2", "A", "Discharge regulator, input current from battery 2", every_second,
           input_current, [](P p) { return p.flows().bdr_in_A[1]; }),
    analog("I_BDROUT", "A", "Discharge regulator, output current", every_second, bus_current,
           [](P p) { return p.flows().bdr_out_A; }),
    analog("I_BAT1", "A", "Battery 1, current, positive when it charges", every_second,
           battery_current, [](P p) { return p.flows().battery_A[0]; }),
    analog("I_BAT2", "A", "Battery 2, current, positive when it charges", every_second,
           battery_current, [](P p) { return p.flows().battery_A[1]; }),
    analog("I_SAG1A", "A", "Solar array section 1A, current", every_second, section_current,
           [](P p) { return p.flows().section_A[0]; }),
    analog("I_SAG1B", "A", "Solar array section 1B, current", every_second, section_current,
           [](P p) { return p.flows().section_A[1]; }),
    analog("I_SGBCHC", "A", "Charge controller 1, current to battery 1", every_second,
           section_current, [](P p) { return p.flows().charge_A[0]; }),
    analog("I_SGBCHC2", "A", "Charge controller 2, current to battery 2", every_second,
           section_current, [](P p) { return p.flows().charge_A[1]; }),
    analog("I_SAG2", "A", "Solar array section 2, current of all channels", every_second,
           bus_current, [](P p) { return p.flows().array_A; }),
    analog("I_SG2", "A", "Solar array section 2, current to the bus", every_second, bus_current,
           [](P p) { return p.flows().sg2_A; }),
    analog("I_SHUNT", "A", "Shunt, current of all channels", every_second, bus_current,
           [](P p) { return p.flows().shunt_A; }),
    analog("I_BUS", "A", "Main bus, current", every_second, bus_current,
           [](P p) { return p.flows().bus_A; }),
    analog("I_DIST", "A", "Distributor, current", every_second, bus_current,
           [](P p) { return p.flows().distributor_A; }),
    analog("V_BUS", "V", "Main bus, voltage", every_second, bus_voltage,
           [](P p) { return p.flows().bus_V; }),
    analog("V_BUSD", "V", "Distributor, voltage", every_second, bus_voltage,
           [](P p) { return p.flows().distributor_V; }),
    analog("V_BAT1", "V", "Battery 1, voltage", every_second, battery_voltage,
           [](P p) { return p.flows().battery_V[0]; }),
    analog("V_BAT2", "V", "Battery 2, voltage", every_second, battery_voltage,
           [](P p) { return p.flows().battery_V[1]; }),
    analog("V_MEA", "V", "Main error amplifier, output voltage", every_second, amplifier_voltage,
           [](P p) { return p.flows().mea_V; }),
    analog("V_MEAB", "V", "Main error amplifier, output voltage, second measurement", every_second,
           amplifier_voltage, [](P p) { return p.flows().mea_V; }),
    analog("I_CSH1", "A", "Charge controller 1, shunted current", every_second, section_current,
           [](P p) { return p.flows().section_shunt_A[0]; }),
    analog("I_CSH2", "A", "Charge controller 2, shunted current", every_second, section_current,
           [](P p) { return p.flows().section_shunt_A[1]; }),
};

// What the loads take, every second.
constexpr std::array load_points = {
    analog("I_PF", "A", "Platform on the bus itself, current", every_second, load_current,
           [](P p) { return p.flows().load_A[platform]; }),
    analog("I_TX", "A", "Transmitter, current", every_second, load_current,
           [](P p) { return p.flows().load_A[transmitter]; }),
    analog("I_HTR", "A", "All heaters, current", every_second, load_current,
           [](P p) { return heaters_A(p); }),
    analog("I_DC1IN", "A", "DC/DC converter 1 (logic, 5 V), input current", every_second,
           load_current, [](P p) { return p.flows().load_A[converter_1]; }),
    analog("I_DC2IN", "A", "DC/DC converter 2 (analog, 15 V), input current", every_second,
           load_current, [](P p) { return p.flows().load_A[converter_1 + 1]; }),
    analog("I_DC3IN", "A", "DC/DC converter 3 (cameras, 12 V), input current", every_second,
           load_current, [](P p) { return p.flows().load_A[converter_1 + 2]; }),
    analog("I_DC1OUT", "A", "DC/DC converter 1 (logic, 5 V), output current", every_second,
           line_current, [](P p) { return p.flows().line_A[0]; }),
    analog("I_DC2OUT", "A", "DC/DC converter 2 (analog, 15 V), output current", every_second,
           line_current, [](P p) { return p.flows().line_A[1]; }),
    analog("I_DC3OUT", "A", "DC/DC converter 3 (cameras, 12 V), output current", every_second,
           line_current, [](P p) { return p.flows().line_A[2]; }),
    analog("I_SD1", "A", "Users of DC/DC converter 1 (logic, 5 V), current", every_second,
           line_current, [](P p) { return p.flows().line_A[0]; }),
    analog("I_SD2", "A", "Users of DC/DC converter 2 (analog, 15 V), current", every_second,
           line_current, [](P p) { return p.flows().line_A[1]; }),
    analog("I_SD3", "A", "Users of DC/DC converter 3 (cameras, 12 V), current", every_second,
           line_current, [](P p) { return p.flows().line_A[2]; }),
    digital("S_PAYLOAD", "Cameras on", every_second,
            [](P p) { return p.loads().on().payload ? 1.0 : 0.0; }),
    digital("S_TX", "Transmitter on", every_second,
            [](P p) { return p.loads().on().transmitter ? 1.0 : 0.0; }),
    analog("I_BH1", "A", "Heater of battery 1, current", every_second, heater_current,
           [](P p) { return p.flows().load_A[battery_heater_1]; }),
    analog("I_BH2", "A", "Heater of battery 2, current", every_second, heater_current,
           [](P p) { return p.flows().load_A[battery_heater_2]; }),
    analog("I_EH", "A", "Heater of the equipment, current", every_second, heater_current,
           [](P p) { return p.flows().load_A[equipment_heater]; }),
};

// Second measurements and output voltages, every 4 s.
constexpr std::array slow_points = {
    analog("V_SAG1A", "V", "Solar array section 1A, voltage", Rate{4, 0}, battery_voltage,
           [](P p) { return p.flows().section_V[0]; }),
    analog("V_SAG1B", "V", "Solar array section 1B, voltage", Rate{4, 0}, battery_voltage,
           [](P p) { return p.flows().section_V[1]; }),
    analog("V_CHC1", "V", "Charge controller 1, output voltage", Rate{4, 1}, battery_voltage,
           [](P p) { return p.flows().battery_V[0]; }),
    analog("V_CHC2", "V", "Charge controller 2, output voltage", Rate{4, 1}, battery_voltage,
           [](P p) { return p.flows().battery_V[1]; }),
    analog("V_BDRIN1", "V", "Discharge regulator, input voltage from battery 1", Rate{4, 2},
           battery_voltage, [](P p) { return p.flows().battery_V[0]; }),
    analog("V_BDRIN2", "V", "Discharge regulator, input voltage from battery 2", Rate{4, 2},
           battery_voltage, [](P p) { return p.flows().battery_V[1]; }),
    analog("V_DC1OUT", "V", "DC/DC converter 1 (logic, 5 V), output voltage", Rate{4, 0},
           line_voltage, [](P p) { return p.flows().line_V[0]; }),
    analog("V_DC2OUT", "V", "DC/DC converter 2 (analog, 15 V), output voltage", Rate{4, 1},
           line_voltage, [](P p) { return p.flows().line_V[1]; }),
    analog("V_DC3OUT", "V", "DC/DC converter 3 (cameras, 12 V), output voltage", Rate{4, 2},
           line_voltage, [](P p) { return p.flows().line_V[2]; }),
};

// States, in turn.
constexpr std::array state_points = {
    digital("S_BHC1", "Heater of battery 1 on", Rate{4, 0},
            [](P p) { return p.loads().battery_heater_on(0) ? 1.0 : 0.0; }),
    digital("S_BHC2", "Heater of battery 2 on", Rate{4, 1},
            [](P p) { return p.loads().battery_heater_on(1) ? 1.0 : 0.0; }),
    digital("S_EHC", "Heater of the equipment on", Rate{4, 2},
            [](P p) { return p.loads().equipment_heater_on() ? 1.0 : 0.0; }),
    digital("S_SH1", "Shunt channel 1 shunts for at least half of the time", Rate{8, 0},
            [](P p) { return (p.flows().shunting[0] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SH2", "Shunt channel 2 shunts for at least half of the time", Rate{8, 1},
            [](P p) { return (p.flows().shunting[1] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SH3", "Shunt channel 3 shunts for at least half of the time", Rate{8, 2},
            [](P p) { return (p.flows().shunting[2] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SH4", "Shunt channel 4 shunts for at least half of the time", Rate{8, 3},
            [](P p) { return (p.flows().shunting[3] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SH5", "Shunt channel 5 shunts for at least half of the time", Rate{8, 4},
            [](P p) { return (p.flows().shunting[4] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SH6", "Shunt channel 6 shunts for at least half of the time", Rate{8, 5},
            [](P p) { return (p.flows().shunting[5] >= 0.5) ? 1.0 : 0.0; }),
    digital("S_SAFE", "Safe mode", Rate{8, 7},
            [](P p) { return p.loads().on().safe_mode ? 1.0 : 0.0; }),
    digital("S_CHC1R", "Charge controller 1: the redundant one works", Rate{16, 5},
            [](P p) { return (p.constants().charger_in_use[0] == 1) ? 1.0 : 0.0; }),
    digital("S_CHC2R", "Charge controller 2: the redundant one works", Rate{16, 6},
            [](P p) { return (p.constants().charger_in_use[1] == 1) ? 1.0 : 0.0; }),
    digital("S_BHC1R", "Heater controller of battery 1: the redundant one works", Rate{16, 11},
            [](P p) { return (p.constants().load.heater_in_use[0] == 1) ? 1.0 : 0.0; }),
    digital("S_BHC2R", "Heater controller of battery 2: the redundant one works", Rate{16, 12},
            [](P p) { return (p.constants().load.heater_in_use[1] == 1) ? 1.0 : 0.0; }),
};

// Temperatures, in turn.
constexpr std::array temperature_points = {
    analog("T_BAT1", "degC", "Battery 1, temperature", Rate{16, 2}, temperature,
           [](P p) { return p.battery(0).state().temperature_C; }),
    analog("T_BAT2", "degC", "Battery 2, temperature", Rate{16, 6}, temperature,
           [](P p) { return p.battery(1).state().temperature_C; }),
    analog("T_BDR", "degC", "Discharge regulator, temperature", Rate{16, 10}, temperature,
           [](P p) { return p.bdr().temperature_C(); }),
    analog("T_SAG", "degC", "Solar array, temperature", Rate{16, 14}, array_temperature,
           [](P p) { return p.array().temperature_C(); }),
    analog("T_DCC", "degC", "Plate of the DC/DC converters, temperature", Rate{16, 0}, temperature,
           [](P p) { return p.converters().temperature_C(); }),
    analog("T_EQ", "degC", "Equipment panel, temperature", Rate{32, 8}, temperature,
           [](P p) { return p.loads().equipment_C(); }),
    analog("T_BAT1B", "degC", "Battery 1, temperature, second thermistor", Rate{32, 18},
           temperature, [](P p) { return p.battery(0).state().temperature_C; }),
    analog("T_BAT2B", "degC", "Battery 2, temperature, second thermistor", Rate{32, 24},
           temperature, [](P p) { return p.battery(1).state().temperature_C; }),
    analog("T_BDRB", "degC", "Discharge regulator, temperature, second thermistor", Rate{32, 12},
           temperature, [](P p) { return p.bdr().temperature_C(); }),
    analog("T_DCCB", "degC", "Plate of the DC/DC converters, temperature, second thermistor",
           Rate{32, 28}, temperature, [](P p) { return p.converters().temperature_C(); }),
};

std::vector<TelemetryPoint> all_points() {
  std::vector<TelemetryPoint> all;
  const auto add = [&all](const auto& points) {
    all.insert(all.end(), points.begin(), points.end());
  };
  add(power_points);
  add(load_points);
  add(slow_points);
  add(state_points);
  add(temperature_points);
  return all;
}

}  // namespace

std::span<const TelemetryPoint> telemetry_points() {
  static const std::vector<TelemetryPoint> points = all_points();
  return points;
}

std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft) {
  return descriptors_of(telemetry_points(), spacecraft);
}

}  // namespace reident::satcs::reference
