// Every physical constant of the platform family. PLATFORM.md gives the source of each, or says
// that it is assumed. Ageing and faults are other values of these constants.
#pragma once

#include <array>
#include <cstddef>

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::platform {

inline constexpr std::size_t panel_count = 4;
inline constexpr std::size_t heater_count = 4;
inline constexpr std::size_t wheel_count = 3;
inline constexpr std::size_t amplifier_count = 2;

/// Nodes of the thermal network. Panels, heated nodes and wheels each stand in a row.
enum Node : std::size_t {
  zenith_panel,
  nadir_panel,
  sun_panel,    // on the side of the orbit's plane where the Sun is
  space_panel,  // on the other side
  deck,         // the electronics
  wheel_plate,
  transmitter_plate,
  tank,
  wheel_1,
  wheel_2,
  wheel_3,
  amplifier_case,
  node_count
};
inline constexpr std::size_t first_heated = deck;  // heater k warms node first_heated + k

/// An outer panel: its radiator sees the Sun, the Earth and space.
struct PanelConstants {
  double area_m2 = 0.6;
  double absorptance = 0.22;  // of sunlight
  double emittance = 0.80;
  double earth_view = 0.2;  // view factor to the Earth

  bool operator==(const PanelConstants&) const = default;
};

struct EnvironmentConstants {
  double solar_flux_W_m2 = 1361;  // at 1 AU
  double earth_infrared_W_m2 = 237;
  double albedo = 0.3;
  double sun_sensor_mA = 8;  // at normal incidence of sunlight at 1 AU

  bool operator==(const EnvironmentConstants&) const = default;
};

/// A conducting path between two nodes.
struct LinkConstants {
  Node a = deck;
  Node b = deck;
  double conductance_W_K = 1;

  bool operator==(const LinkConstants&) const = default;
};
inline constexpr std::size_t amplifier_link = 0;

/// A heater with two thermostats, of which one is in use.
struct HeaterConstants {
  double rated_W = 20;                                         // at 28 V
  std::array<reference::ThermostatConstants, 2> thermostat{};  // main, redundant
  std::size_t in_use = 0;
  double share = 1;        // of the power that the heater still has
  double stuck_share = 0;  // of that power, which flows whatever the thermostat says

  bool operator==(const HeaterConstants&) const = default;
};

struct ThermalConstants {
  std::array<double, node_count> heat_capacity_J_K{7000, 7000, 8000, 9000, 30e3, 6000,
                                                   7000, 9000, 2500, 2500, 2500, 900};
  std::array<double, node_count> initial_C{-5, 0, -5, -12, 17, 15, 5, 13, 22, 22, 22, 6};
  std::array<PanelConstants, panel_count> panel{
      PanelConstants{0.60, 0.25, 0.80, 0.0}, PanelConstants{0.42, 0.25, 0.80, 0.8},
      PanelConstants{0.70, 0.22, 0.80, 0.2}, PanelConstants{0.85, 0.20, 0.80, 0.2}};
  double tank_emitting_m2 = 0.03;  // area times emittance of its insulation
  std::array<LinkConstants, 13> link{LinkConstants{amplifier_case, transmitter_plate, 3.5},
                                     LinkConstants{deck, zenith_panel, 2.6},
                                     LinkConstants{deck, nadir_panel, 5.0},
                                     LinkConstants{deck, sun_panel, 2.2},
                                     LinkConstants{deck, space_panel, 2.4},
                                     LinkConstants{deck, wheel_plate, 1.2},
                                     LinkConstants{sun_panel, wheel_plate, 1.5},
                                     LinkConstants{deck, transmitter_plate, 0.8},
                                     LinkConstants{space_panel, transmitter_plate, 1.6},
                                     LinkConstants{deck, tank, 0.25},
                                     LinkConstants{wheel_plate, wheel_1, 0.8},
                                     LinkConstants{wheel_plate, wheel_2, 0.8},
                                     LinkConstants{wheel_plate, wheel_3, 0.8}};
  std::array<HeaterConstants, heater_count> heater{
      HeaterConstants{60, {{{11, 14}, {10, 13.5}}}}, HeaterConstants{32, {{{13, 16}, {12, 15.5}}}},
      HeaterConstants{32, {{{3, 6}, {1.5, 5.5}}}}, HeaterConstants{24, {{{12, 15}, {10, 14}}}}};

  bool operator==(const ThermalConstants&) const = default;
};

struct SupplyConstants {
  double bus_V = 28;
  double sunlit_V = 0.25;  // more in sunlight
  double source_ohm = 0.006;
  double sigma_V = 0.06;  // slow variation
  double correlation_s = 400;
  double electronics_W = 180;  // of the deck
  double payload_W = 90;       // more while the cameras are on
  double safe_W = 110;         // in safe mode
  double electronics_sigma_W = 5;
  double electronics_correlation_s = 600;

  bool operator==(const SupplyConstants&) const = default;
};

/// A reaction wheel and its drive.
struct WheelConstants {
  double inertia_kg_m2 = 0.04;
  double torque_Nm_A = 0.06;  // of the motor
  double current_max_A = 2.5;
  double winding_ohm = 1.5;
  double current_loop_s = 0.6;  // the current follows its command
  double drive_W = 4;           // of the electronics
  double coulomb_Nm = 2.5e-3;
  double stribeck_Nm = 1.5e-3;  // more at rest
  double stribeck_rad_s = 8;
  double viscous_Nms = 3.5e-5;   // at 20 degC
  double viscous_per_K = -0.03;  // relative, exponential
  double ripple = 0.03;          // slow variation of the friction, relative
  double ripple_correlation_s = 300;

  bool operator==(const WheelConstants&) const = default;
};

/// One axis of the attitude loop, which commands the wheel's torque.
struct AxisConstants {
  double body_kg_m2 = 1500;
  double bandwidth_rad_s = 0.03;
  double integral_share = 0.15;  // of the bandwidth
  double rate_noise_rad_s = 3e-6;
  double secular_Nm = 1.5e-4;  // of the disturbance torque
  double orbital_Nm = 1.2e-3;  // amplitude, once an orbit
  double twice_Nm = 4e-4;      // twice an orbit
  double pressure_Nm = 1e-4;   // of sunlight
  double bias_rad_s = 200;     // of the wheel, which unloading leads back to
  double unload_from_rad_s = 70;
  double unload_until_rad_s = 8;
  double unload_Nm = 3e-3;
  double slew_deg = 15;  // at most

  bool operator==(const AxisConstants&) const = default;
};

struct SlewConstants {
  int slots = 4;             // in an orbit; a slew and its way back lie in one
  double probability = 0.6;  // of a slew in a slot
  double ramp_s = 240;       // there, and back
  double hold_min_s = 200;
  double hold_max_s = 500;

  bool operator==(const SlewConstants&) const = default;
};

/// A solid-state power amplifier.
struct AmplifierConstants {
  double gain_dB = 37;  // at 25 degC
  double gain_dB_per_K = -0.03;
  double saturation_W = 45;
  double quiescent_W = 9;
  double quiescent_per_K = 4e-3;  // relative to 25 degC
  double direct_share = 1.2;      // of the output
  double root_share = 0.9;        // of the root of output times saturation
  double warm_up_dB = 1.0;        // less when it is switched on
  double warm_up_s = 25;

  bool operator==(const AmplifierConstants&) const = default;
};

struct TransmitterConstants {
  std::array<AmplifierConstants, amplifier_count> amplifier{
      AmplifierConstants{},
      AmplifierConstants{.gain_dB = 36.4, .quiescent_W = 10, .root_share = 0.97}};
  std::size_t in_use = 0;
  double drive_min_mW = 1.5;
  double drive_max_mW = 8;
  double drive_step = 0.35;          // largest change within a pass, relative
  double step_s = 60;                // a drive level lasts so long
  double session_probability = 0.7;  // of each of two ranging sessions in an orbit
  double session_min_s = 240;
  double session_max_s = 540;

  bool operator==(const TransmitterConstants&) const = default;
};

struct Constants {
  reference::OrbitConstants orbit;
  reference::LoadConstants plan;  // of the operations
  EnvironmentConstants environment;
  ThermalConstants thermal;
  SupplyConstants supply;
  std::array<WheelConstants, wheel_count> wheel{
      WheelConstants{}, WheelConstants{.coulomb_Nm = 2.9e-3, .viscous_Nms = 3.9e-5},
      WheelConstants{.coulomb_Nm = 2.2e-3, .viscous_Nms = 3.2e-5}};
  std::array<AxisConstants, wheel_count> axis{
      AxisConstants{}, AxisConstants{.body_kg_m2 = 1800, .bias_rad_s = -180, .slew_deg = 6},
      AxisConstants{.body_kg_m2 = 1200, .bias_rad_s = 0, .slew_deg = 10}};
  SlewConstants slew;
  TransmitterConstants transmitter;

  bool operator==(const Constants&) const = default;
};

}  // namespace reident::satcs::platform
