// Every physical constant of the reference spacecraft. REFERENCE.md gives the source of each, or
// says that it is assumed. Ageing and faults are other values of these constants.
#pragma once

#include <array>
#include <cstddef>

namespace reident::satcs::reference {

inline constexpr std::size_t battery_count = 2;
inline constexpr std::size_t shunt_channels = 6;
inline constexpr std::size_t converter_count = 3;
inline constexpr std::size_t section_count = 3;  // SAG1A, SAG1B, SAG2

struct OrbitConstants {
  double period_s = 100.26 * 60;
  double semi_major_axis_km = 7148.865;
  double inclination_deg = 98.504;
  double local_time_descending_h = 10.5;  // mean local time at the descending node
  double earth_radius_km = 6378.137;
  double sun_radius_deg = 0.2666;  // angular
  double obliquity_deg = 23.439;
  double earth_eccentricity = 0.0167;
  double min_elevation_deg = 5;  // above which a station sees the spacecraft

  bool operator==(const OrbitConstants&) const = default;
};

struct ArrayConstants {
  double cant_deg = 22.5;          // of the wing towards the mean beta angle
  double string_current_A = 0.50;  // at normal incidence, 1 AU and 28 degC
  double current_per_K = 6e-4;     // relative
  double cell_open_V = 2.66;       // at 28 degC
  double cell_open_V_per_K = -6.0e-3;
  double cell_knee_V = 0.075;  // slope of the exponential knee
  double blocking_diode_V = 0.8;
  int charge_cells = 26;                                  // in series, SAG1A and SAG1B
  std::array<int, battery_count> charge_strings{13, 13};  // in parallel, SAG1A and SAG1B
  int bus_cells = 16;                                     // in series, SAG2
  std::array<int, shunt_channels> bus_strings{15, 15, 15, 15, 15, 15};
  std::array<double, section_count> section_share{1, 1, 1};  // of the new strings' current
  double shunt_drop_V = 0.7;         // of a shunting switch, before the blocking diode
  double area_m2 = 8;                // of all sections
  double solar_flux_W_m2 = 1361;     // at 1 AU
  double absorptance = 0.85;         // of the front, before electrical power is taken out
  double emittance = 0.85;           // of each face
  double earth_infrared_W_m2 = 160;  // absorbed
  double heat_capacity_J_m2K = 4500;

  bool operator==(const ArrayConstants&) const = default;
};

struct BatteryConstants {
  int cells = 38;
  double capacity_Ah = 50;
  /// Open-circuit voltage of a cell at 10 degC at states of charge 0, 0.05, ... 1.
  std::array<double, 21> cell_open_V{1.100, 1.185, 1.215, 1.232, 1.244, 1.253, 1.260,
                                     1.266, 1.272, 1.278, 1.284, 1.290, 1.296, 1.302,
                                     1.309, 1.317, 1.326, 1.338, 1.355, 1.390, 1.455};
  double cell_open_V_per_K = -4e-4;
  double series_ohm = 0.045;
  double fast_ohm = 0.025;
  double fast_s = 40;
  double slow_ohm = 0.040;
  double slow_s = 700;
  double charge_efficiency = 0.985;  // far from full
  double full_soc = 0.985;           // half of the current is stored here
  double full_width = 0.012;
  double heat_capacity_J_K = 42e3;
  double conductance_W_K = 1.6;  // to the radiator
  double radiator_C = -8;
  double initial_soc = 0.95;
  double initial_C = 8;

  bool operator==(const BatteryConstants&) const = default;
};

/// Battery charge controller: a shunt across the section, which limits the battery's voltage.
struct ChargerConstants {
  int cells = 38;               // that its limit is set for
  double cell_limit_V = 1.425;  // at 10 degC
  double cell_limit_V_per_K = -2.5e-3;
  double gain_per_Vs = 0.15;  // of the shunted share
  double drop_V = 0.6;        // from the section to the battery
  double knee_A = 0.1;        // at which the drop is half of that
  double series_ohm = 0.030;

  bool operator==(const ChargerConstants&) const = default;
};

/// Battery switching regulators: one module for each battery, one output.
struct DischargeRegulatorConstants {
  double max_output_A = 60;   // both modules
  double least_input_V = 32;  // of the battery without current; a module stops below it
  double idle_W = 5;          // of each module
  double drop_V = 0.55;
  double series_ohm = 0.035;  // at 25 degC
  double series_per_K = 5e-3;
  double switching = 0.006;     // loss over battery voltage and output current
  double sharing_per_V = 0.06;  // share moved for each volt between the batteries
  double sharing_s = 25;
  double heat_capacity_J_K = 5200;
  double conductance_W_K = 3.5;
  double base_C = 15;

  bool operator==(const DischargeRegulatorConstants&) const = default;
};

/// Main error amplifier and the domains of its output.
struct ErrorAmplifierConstants {
  double reference_V = 28.0;
  double gain = 10;
  double integral_s = 8;    // error over time that moves the output like the error itself
  double middle_V = 5.5;    // output for no error and an empty integrator
  double high_rail_V = 13;  // the low rail is 0
  double bdr_full_V = 1;    // the regulators give all they can below it
  double bdr_zero_V = 5;
  double shunt_first_V = 6;  // the first channel begins to shunt
  double shunt_step_V = 1;   // from one channel to the next

  bool operator==(const ErrorAmplifierConstants&) const = default;
};

struct BusConstants {
  double capacitance_F = 0.02;
  double fold_back_V = 20;     // loads take less current rather than pull the bus below it
  double harness_ohm = 0.004;  // from the bus to the distributor

  bool operator==(const BusConstants&) const = default;
};

/// A DC/DC converter and its secondary line.
struct ConverterConstants {
  double output_V = 5;       // without load
  double output_ohm = 2e-3;  // droop
  double idle_W = 6;
  double drop_V = 0.35;
  double series_ohm = 6e-3;  // at 25 degC

  bool operator==(const ConverterConstants&) const = default;
};

/// The converters' common plate.
struct ConverterPlateConstants {
  double series_per_K = 4e-3;
  double heat_capacity_J_K = 3000;
  double conductance_W_K = 2.2;
  double base_C = 12;

  bool operator==(const ConverterPlateConstants&) const = default;
};

/// The secondary lines: 5 V for logic, 15 V for analog electronics, 12 V for the cameras.
enum SecondaryLine : std::size_t { logic_line, analog_line, camera_line };

/// What a secondary line's users take.
struct LineConstants {
  double base_A = 0;
  double payload_A = 0;      // more while the cameras are on
  double transmitter_A = 0;  // more while the transmitter is on
  double sigma_A = 0;        // slow variation
  double correlation_s = 60;

  bool operator==(const LineConstants&) const = default;
};

struct ThermostatConstants {
  double on_C = 0;
  double off_C = 0;

  bool operator==(const ThermostatConstants&) const = default;
};

struct LoadConstants {
  double platform_W = 380;       // what runs on the bus itself
  double platform_safe_W = 250;  // in safe mode
  double platform_sigma_W = 12;  // slow variation
  double platform_correlation_s = 240;
  std::array<LineConstants, converter_count> line{LineConstants{18, 2, 4, 0.6, 90},
                                                  LineConstants{7, 0, 0, 0.35, 150},
                                                  LineConstants{2.8, 21.2, 0, 0.3, 30}};
  double transmitter_W = 230;
  double equipment_heater_W = 95;                                                    // at 28 V
  double battery_heater_W = 45;                                                      // at 28 V
  std::array<ThermostatConstants, 2> battery_heater{ThermostatConstants{5, 7},       // main
                                                    ThermostatConstants{4.2, 7.4}};  // redundant
  std::array<std::size_t, battery_count> heater_in_use{0, 0};  // controller of each battery
  ThermostatConstants equipment_heater{17, 20};
  double equipment_capacity_J_K = 9000;
  double equipment_conductance_W_K = 4.5;
  double equipment_sink_C = 2;        // in eclipse
  double equipment_sun_K = 9;         // the sink is warmer in sunlight
  double session_probability = 0.55;  // of a recorded imaging session in an orbit
  double session_min_s = 240;
  double session_max_s = 660;

  bool operator==(const LoadConstants&) const = default;
};

struct Constants {
  OrbitConstants orbit;
  ArrayConstants array;
  std::array<BatteryConstants, battery_count> battery{
      BatteryConstants{}, BatteryConstants{.capacity_Ah = 49.2, .series_ohm = 0.048}};
  std::array<ChargerConstants, 2> charger{
      // main and redundant
      ChargerConstants{}, ChargerConstants{.cell_limit_V = 1.431, .gain_per_Vs = 0.11}};
  std::array<std::size_t, battery_count> charger_in_use{0, 0};  // of each battery
  DischargeRegulatorConstants bdr;
  ErrorAmplifierConstants mea;
  BusConstants bus;
  std::array<ConverterConstants, converter_count> converter{
      ConverterConstants{}, ConverterConstants{15, 8e-3, 5, 0.5, 30e-3},
      ConverterConstants{12, 4e-3, 8, 0.6, 35e-3}};
  ConverterPlateConstants converter_plate;
  LoadConstants load;

  bool operator==(const Constants&) const = default;
};

}  // namespace reident::satcs::reference
