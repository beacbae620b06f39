#include "service/satcs/platform/platform_life.hpp"

namespace reident::satcs::platform {
namespace {

using reference::LifeEvent;
using reference::LifeKind;

/// Those of an array that the event is about.
void each(const LifeEvent& event, auto& all, const auto& change) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (event.unit == 0 || event.unit == static_cast<int>(i + 1)) change(all[i]);
}

void apply_to_thermal(const LifeEvent& event, double grown, ThermalConstants& c) {
  const double change = event.magnitude * grown;
  switch (event.kind) {
    case LifeKind::paint_degradation:
      each(event, c.panel, [&](PanelConstants& panel) { panel.absorptance += change; });
      break;
    case LifeKind::interface_loss:
      c.link[amplifier_link].conductance_W_K *= 1 - change;
      break;
    case LifeKind::insulation_loss:
      c.tank_emitting_m2 *= 1 + change;
      break;
    case LifeKind::heater_loss:
      each(event, c.heater, [&](HeaterConstants& heater) { heater.share *= 1 - change; });
      break;
    case LifeKind::heater_stuck:
      each(event, c.heater, [&](HeaterConstants& heater) { heater.stuck_share = change; });
      break;
    case LifeKind::thermostat_shift:
      each(event, c.heater, [&](HeaterConstants& heater) {
        for (auto& thermostat : heater.thermostat) {
          thermostat.on_C += change;
          thermostat.off_C += change;
        }
      });
      break;
    case LifeKind::redundant_thermostat:
      each(event, c.heater, [&](HeaterConstants& heater) { heater.in_use = 1; });
      break;
    default:
      break;
  }
}

void apply_to_wheels(const LifeEvent& event, double grown, Constants& c) {
  const double change = event.magnitude * grown;
  switch (event.kind) {
    case LifeKind::bearing_wear:
    case LifeKind::bearing_instability:
      each(event, c.wheel, [&](WheelConstants& wheel) {
        wheel.coulomb_Nm *= 1 + change;
        wheel.viscous_Nms *= 1 + change;
      });
      break;
    case LifeKind::lubricant_loss:
      // Less oil drags less, and lets metal touch metal.
      each(event, c.wheel, [&](WheelConstants& wheel) {
        wheel.viscous_Nms *= 1 - change;
        wheel.coulomb_Nm *= 1 + 3 * change;
        wheel.stribeck_Nm *= 1 + 3 * change;
      });
      break;
    case LifeKind::motor_fade:
      each(event, c.wheel, [&](WheelConstants& wheel) { wheel.torque_Nm_A *= 1 - change; });
      break;
    default:
      break;
  }
}

void apply_to_transmitter(const LifeEvent& event, double grown, TransmitterConstants& c) {
  const double change = event.magnitude * grown;
  switch (event.kind) {
    case LifeKind::gain_drop:
      for (AmplifierConstants& amplifier : c.amplifier) amplifier.gain_dB -= change;
      break;
    case LifeKind::quiescent_growth:
      for (AmplifierConstants& amplifier : c.amplifier) amplifier.quiescent_W *= 1 + change;
      break;
    case LifeKind::redundant_amplifier:
      c.in_use = 1;
      break;
    default:
      break;
  }
}

}  // namespace

Constants aged(const Constants& fresh, std::span<const LifeEvent> life, storage::Time time) {
  Constants constants = fresh;
  for (const LifeEvent& event : life) {
    const double grown = reference::progress(event, time);
    if (grown == 0) continue;
    apply_to_thermal(event, grown, constants.thermal);
    apply_to_wheels(event, grown, constants);
    apply_to_transmitter(event, grown, constants.transmitter);
  }
  return constants;
}

}  // namespace reident::satcs::platform
