// What happens to the reference spacecraft over the years: ageing, faults, switches to redundant
// units, and times of special operations. Each kind is of the power subsystem, of the platform,
// or of both.
//
// Life is nothing but other constants at a time (aged()); the plant takes them second by second, so
// that the same events give the same telemetry whatever the start. REFERENCE.md lists the kinds of
// the power subsystem, ../platform/PLATFORM.md those of the platform.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "service/satcs/family.hpp"
#include "service/satcs/reference/reference_constants.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// What happens.
enum class LifeKind {
  // Changes that stay. With an end after the beginning they grow linearly, otherwise they are
  // steps.
  array_degradation,  // magnitude: share of the strings' current lost; unit: section
  capacity_fade,      // magnitude: share of the capacity lost; unit: battery
  rising_resistance,  // magnitude: relative growth of every resistance; unit: battery
  efficiency_drift,   // magnitude: relative growth of the discharge regulators' losses; unit: none
  converter_drift,    // magnitude: relative growth of a DC/DC converter's losses; unit: converter
  lost_string,        // magnitude: strings lost; unit: row of strings; always a step
  failed_cell,        // magnitude: cells shorted; unit: battery; always a step
  // Modes: from the beginning to the end, or for good when both are the same. No magnitude.
  redundant_charger,  // unit: battery
  redundant_heater,   // the battery's heater controller; unit: battery
  safe_mode,          // the payload and the transmitter off, the platform at its least; unit: none
  quiet,              // neither imaging nor transmission; unit: none
  // The platform's changes that stay.
  paint_degradation,  // magnitude: growth of the absorptance; unit: panel
  interface_loss,     // magnitude: share of the amplifier's conductance lost; unit: none
  insulation_loss,    // magnitude: relative growth of what the tank radiates; unit: none
  heater_loss,        // magnitude: share of the heater's power lost; unit: heater
  thermostat_shift,   // magnitude: both thresholds rise [K]; unit: heater
  bearing_wear,       // magnitude: relative growth of the friction; unit: wheel
  lubricant_loss,     // magnitude: share of the viscous friction lost; unit: wheel
  motor_fade,         // magnitude: share of the motor's constant lost; unit: wheel
  gain_drop,          // magnitude: gain of the amplifiers lost [dB]; unit: none
  quiescent_growth,   // magnitude: relative growth of the amplifiers' quiescent power; unit: none
  // The platform's modes; two have a magnitude.
  heater_stuck,          // magnitude: share of the power that flows all the time; unit: heater
  redundant_thermostat,  // unit: heater
  bearing_instability,   // magnitude: relative growth of the friction while it lasts; unit: wheel
  redundant_amplifier,   // unit: none
};

/// What `LifeEvent::unit` counts, from 1.
enum class LifeUnit {
  none,
  battery,     // 1, 2; 0: both
  section,     // 1 SAG1A, 2 SAG1B, 3 SAG2; 0: all
  converter,   // 1 logic, 2 analog, 3 cameras; 0: all
  string_row,  // 1 SAG1A, 2 SAG1B, 3 to 8 the channels of SAG2
  panel,       // 1 zenith, 2 nadir, 3 sun side, 4 space side; 0: all
  heater,      // 1 deck, 2 wheels' plate, 3 transmitter's plate, 4 tank; 0: all
  wheel,       // 1 to 3; 0: all
};

/// One event. Functions below but life_mistake() require one without a mistake.
struct LifeEvent {
  LifeKind kind = LifeKind::array_degradation;
  storage::Time begin = 0;
  storage::Time end = 0;  // as `begin` for a step, and for a mode that lasts for good
  double magnitude = 0;   // of a mode: 1
  int unit = 0;           // what LifeUnit says; 0 where it takes none
};

/// "array_degradation" and so on.
std::string_view name(LifeKind kind);
/// Every kind, in the order of their declaration.
std::span<const LifeKind> life_kinds();
/// Whether a kind happens to equipment of the family.
bool happens_to(Family family, LifeKind kind);
LifeUnit unit_of(LifeKind kind);
/// An event with its kind's usual magnitude and unit.
LifeEvent usual(LifeKind kind, storage::Time begin, storage::Time end);

/// What is wrong with an event, with the remedy; empty when it can happen.
std::string life_mistake(const LifeEvent& event);

/// What has grown of a change that stays, in [0, 1]; of a mode, 1 while it lasts.
double progress(const LifeEvent& event, storage::Time time);
/// Whether an event of a mode lasts at `time`.
bool in_mode(std::span<const LifeEvent> life, LifeKind mode, storage::Time time);

/// The constants at `time` of a spacecraft that was launched with `fresh`.
Constants aged(const Constants& fresh, std::span<const LifeEvent> life, storage::Time time);
/// Whether aged() may differ between the two times.
bool ages_between(std::span<const LifeEvent> life, storage::Time from, storage::Time to);

}  // namespace reident::satcs::reference
