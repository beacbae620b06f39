#include "tests/trust/plans.hpp"

#include <array>

namespace reident::trust {
namespace {

using satcs::FaultKind;
using satcs::reference::LifeKind;

std::vector<LifePlan> power_lives() {
  using enum LifeKind;
  return {
      {"none", {}, {"BDR"}},
      {"none", {}, {"BAT1"}, 120},
      {"none", {}, {"MEA"}, 240},
      {"none", {}, {"SAG2", "DCDC3"}, 300},
      {"array_degradation", {{array_degradation, 0.05, 0, 0, 12}}, {"SAG2"}},
      {"array_degradation", {{array_degradation, 0.20, 3, 0, 0}}, {"MEA", "SAG2"}, 90},
      {"capacity_fade", {{capacity_fade, 0.10, 0, 0, 12}}, {"BAT1"}, 30},
      {"capacity_fade", {{capacity_fade, 0.30, 1, 0, 0}}, {"BAT1"}, 200},
      {"capacity_fade", {{capacity_fade, 0.50, 1, 0, 0}}, {"BAT1"}},
      {"rising_resistance", {{rising_resistance, 0.5, 0, 0, 12}}, {"BAT1"}},
      {"rising_resistance", {{rising_resistance, 2.0, 0, 0, 12}}, {"BAT1"}, 150},
      {"rising_resistance", {{rising_resistance, 1.0, 1, 0, 0}}, {"BAT1"}, 60},
      {"efficiency_drift", {{efficiency_drift, 0.3, 0, 0, 12}}, {"BDR"}},
      {"efficiency_drift", {{efficiency_drift, 1.0, 0, 0, 0}}, {"BDR"}, 270},
      {"efficiency_drift", {{efficiency_drift, 3.0, 0, 0, 10}}, {"BDR"}, 180},
      {"lost_string", {{lost_string, 1, 1, 0, 0}}, {"BAT1"}},
      {"lost_string", {{lost_string, 6, 1, 0, 0}}, {"BAT1"}, 330},
      {"lost_string", {{lost_string, 3, 3, 0, 0}}, {"SAG2"}},
      {"failed_cell", {{failed_cell, 1, 1, 0, 0}}, {"BAT1"}},
      {"failed_cell", {{failed_cell, 2, 1, 0, 0}}, {"BDR", "BAT1"}, 100},
      {"failed_cell", {{failed_cell, 2, 2, 0, 0}}, {"BAT2"}},
      {"redundant_charger", {{redundant_charger, 1, 1, 0, 0}}, {"CHC1"}, 45},
      {"redundant_charger", {{redundant_charger, 1, 1, 0, 5}}, {"BAT1"}},
      {"safe_mode", {{safe_mode, 1, 0, 0, 1}}, {"DIST"}},
      {"safe_mode", {{safe_mode, 1, 0, 0, 3}}, {"MEA"}, 210},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"BAT1"}},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"DIST"}, 75},
      {"ageing",
       {{array_degradation, 0.03, 0, 0, 12},
        {capacity_fade, 0.08, 0, 0, 12},
        {rising_resistance, 0.4, 0, 0, 12},
        {efficiency_drift, 0.3, 0, 0, 12}},
       {"BDR", "BAT1"}},
      {"ageing",
       {{array_degradation, 0.08, 0, 0, 12},
        {capacity_fade, 0.15, 0, 0, 12},
        {rising_resistance, 0.8, 0, 0, 12},
        {efficiency_drift, 0.6, 0, 0, 12}},
       {"MEA"},
       160},
      {"two_failures",
       {{failed_cell, 1, 1, 0, 0}, {efficiency_drift, 1.0, 0, 6, 0}},
       {"BDR", "BAT1"},
       20},
      {"failure_in_safe_mode", {{safe_mode, 1, 0, -0.2, 1}, {lost_string, 4, 4, 0, 0}}, {"MEA"}},
      {"failure_in_safe_mode",
       {{safe_mode, 1, 0, -0.2, 1}, {failed_cell, 1, 1, 0, 0}},
       {"BAT1"},
       130},
      {"converter_drift", {{converter_drift, 1.0, 3, 0, 0}}, {"DCDC3"}},
      {"converter_drift", {{converter_drift, 0.5, 0, 0, 12}}, {"DCDC3"}, 250},
      {"redundant_heater", {{redundant_heater, 1, 1, 0, 0}}, {"BAT1"}, 10},
  };
}

/// Never looked at when a rule of the gate is made (README.md).
std::vector<LifePlan> platform_lives() {
  using enum LifeKind;
  return {
      {"none", {}, {"PANELS"}},
      {"none", {}, {"RW3"}, 90},
      {"none", {}, {"RW2"}, 180},
      {"none", {}, {"PAC"}, 270},
      {"none", {}, {"DECK"}, 45},
      // The beta angle and the Sun's distance change most quickly.
      {"season", {}, {"PSUN"}, 60},
      {"season", {}, {"PANELS"}, 235},
      {"paint_degradation", {{paint_degradation, 0.03, 3, 0, 12}}, {"PSUN"}, 30},
      {"paint_degradation", {{paint_degradation, 0.25, 0, 0, 12}}, {"PANELS"}, 150},
      {"paint_degradation", {{paint_degradation, 0.15, 3, 0, 0}}, {"PSUN"}, 200},
      {"interface_loss", {{interface_loss, 0.15, 0, 0, 0}}, {"PAC"}, 20},
      {"interface_loss", {{interface_loss, 0.6, 0, 0, 0}}, {"PAC"}, 120},
      {"insulation_loss", {{insulation_loss, 0.3, 0, 0, 12}}, {"TANK"}, 70},
      {"insulation_loss", {{insulation_loss, 1.0, 0, 0, 0}}, {"TANK"}, 310},
      {"heater_loss", {{heater_loss, 1.0, 3, 0, 0}}, {"TPL"}, 170},
      {"heater_stuck", {{heater_stuck, 0.5, 4, 0, 4}}, {"TANK"}, 260},
      {"thermostat_shift", {{thermostat_shift, 3, 1, 0, 12}}, {"DECK"}, 100},
      {"redundant_thermostat", {{redundant_thermostat, 1, 4, 0, 5}}, {"TANK"}, 330},
      {"bearing_wear", {{bearing_wear, 0.15, 1, 0, 0}}, {"RW1"}},
      {"bearing_wear", {{bearing_wear, 1.0, 1, 0, 0}}, {"RW1", "RWD1"}, 140},
      {"bearing_wear", {{bearing_wear, 0.8, 2, 0, 12}}, {"RW2"}, 290},
      {"bearing_wear", {{bearing_wear, 1.5, 3, 0, 0}}, {"RW3"}, 50},
      {"bearing_instability", {{bearing_instability, 1.0, 1, 0, 4}}, {"RW1"}, 220},
      {"lubricant_loss", {{lubricant_loss, 0.3, 1, 0, 12}}, {"RW1"}, 80},
      {"lubricant_loss", {{lubricant_loss, 0.7, 2, 0, 0}}, {"RW2"}, 190},
      {"motor_fade", {{motor_fade, 0.03, 1, 0, 0}}, {"RW1"}, 340},
      {"motor_fade", {{motor_fade, 0.15, 2, 0, 0}}, {"RW2"}, 110},
      {"gain_drop", {{gain_drop, 0.3, 0, 0, 0}}, {"PA"}, 15},
      {"gain_drop", {{gain_drop, 2.0, 0, 0, 0}}, {"PA"}, 160},
      {"gain_drop", {{gain_drop, 1.0, 0, 0, 12}}, {"PA"}, 280},
      {"quiescent_growth", {{quiescent_growth, 1.0, 0, 0, 0}}, {"PA"}, 210},
      {"redundant_amplifier", {{redundant_amplifier, 1, 0, 0, 5}}, {"PA"}, 40},
      {"safe_mode", {{safe_mode, 1, 0, 0, 1.5}}, {"DECK"}, 130},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"RW2"}, 250},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"PAC"}, 25},
      {"two_failures", {{bearing_wear, 0.6, 1, 0, 0}, {lubricant_loss, 0.5, 1, 6, 0}}, {"RW1"}, 60},
      {"two_failures", {{gain_drop, 1.0, 0, 0, 0}, {gain_drop, 0.8, 0, 5, 0}}, {"PA"}, 320},
      {"failure_in_safe_mode",
       {{safe_mode, 1, 0, -0.2, 1}, {bearing_wear, 1.0, 1, 0, 0}},
       {"RW1"},
       180},
      {"ageing",
       {{paint_degradation, 0.08, 0, 0, 12},
        {bearing_wear, 0.4, 0, 0, 12},
        {gain_drop, 0.7, 0, 0, 12},
        {quiescent_growth, 0.3, 0, 0, 12}},
       {"RW1", "PA"},
       5},
  };
}

}  // namespace

std::vector<LifePlan> life_plans(satcs::Family family) {
  return family == satcs::Family::power ? power_lives() : platform_lives();
}

std::vector<FaultPlan> fault_plans() {
  using enum FaultKind;
  std::vector<FaultPlan> plans;
  constexpr std::array roles{Role::output, Role::first_input, Role::last_input};
  for (const FaultKind kind : {bias_step, drifting_bias, noise_burst, spikes})
    for (const Role role : roles)
      for (const double share : {0.5, 2.0}) plans.push_back({kind, role, share});
  for (const FaultKind kind : {stuck, stops, wrong_calibration, swapped})
    for (const Role role : roles) plans.push_back({kind, role});
  for (const double share : {0.05, 0.2, 0.5}) plans.push_back({wrong_validity, Role::none, share});
  for (const double share : {0.1, 0.5}) plans.push_back({frames_lost, Role::none, share});
  for (const double share : {0.3, 0.8}) plans.push_back({passes_lost, Role::none, share});
  for (const FaultKind kind : {backwards_playback, two_stations, two_stamping_stations, time_jump,
                               duplicated_day, repeated_day, simulated_as_real})
    plans.push_back({kind});
  return plans;
}

std::vector<FaultPlan> platform_faults(std::size_t life) {
  constexpr std::array roles{Role::output, Role::first_input, Role::last_input};
  constexpr std::array shares{0.25, 0.5, 1.0};
  const auto bias = [&](std::size_t which, double days, bool on_the_change) {
    return FaultPlan{FaultKind::bias_step, roles[(life + which) % roles.size()],
                     shares[(life / roles.size() + which) % shares.size()], days, on_the_change};
  };
  if (life % 2 == 0) return {bias(0, 1, true), bias(1, 4, false), bias(2, 4, true)};
  const bool gap = life % 4 == 3;
  return {bias(0, 4, true), bias(1, 1, false),
          gap ? FaultPlan{FaultKind::frames_lost, Role::none, 1.0, 1.5, true}
              : FaultPlan{FaultKind::stuck, Role::output, {}, 1, false}};
}

}  // namespace reident::trust
