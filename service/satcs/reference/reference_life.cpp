#include "service/satcs/reference/reference_life.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "service/satcs/platform/platform_constants.hpp"

namespace reident::satcs::reference {
namespace {

enum class Profile { gradual, step, mode };

struct KindInfo {
  LifeKind kind;
  std::string_view name;
  Profile profile;
  LifeUnit unit;
  int usual_unit;
  double usual_magnitude;  // of a mode: 1
  double most;             // that the magnitude may be, above 0
};

constexpr std::array kinds{
    KindInfo{LifeKind::array_degradation, "array_degradation", Profile::gradual, LifeUnit::section,
             0, 0.05, 0.9},
    KindInfo{LifeKind::capacity_fade, "capacity_fade", Profile::gradual, LifeUnit::battery, 0, 0.10,
             0.9},
    KindInfo{LifeKind::rising_resistance, "rising_resistance", Profile::gradual, LifeUnit::battery,
             0, 0.5, 3},
    KindInfo{LifeKind::efficiency_drift, "efficiency_drift", Profile::gradual, LifeUnit::none, 0,
             0.3, 3},
    KindInfo{LifeKind::converter_drift, "converter_drift", Profile::gradual, LifeUnit::converter, 0,
             0.3, 3},
    KindInfo{LifeKind::lost_string, "lost_string", Profile::step, LifeUnit::string_row, 3, 1, 13},
    KindInfo{LifeKind::failed_cell, "failed_cell", Profile::step, LifeUnit::battery, 1, 1, 10},
    KindInfo{LifeKind::redundant_charger, "redundant_charger", Profile::mode, LifeUnit::battery, 1,
             1, 1},
    KindInfo{LifeKind::redundant_heater, "redundant_heater", Profile::mode, LifeUnit::battery, 1, 1,
             1},
    KindInfo{LifeKind::safe_mode, "safe_mode", Profile::mode, LifeUnit::none, 0, 1, 1},
    KindInfo{LifeKind::quiet, "quiet", Profile::mode, LifeUnit::none, 0, 1, 1},
    KindInfo{LifeKind::paint_degradation, "paint_degradation", Profile::gradual, LifeUnit::panel, 0,
             0.05, 0.6},
    KindInfo{LifeKind::interface_loss, "interface_loss", Profile::gradual, LifeUnit::none, 0, 0.3,
             0.9},
    KindInfo{LifeKind::insulation_loss, "insulation_loss", Profile::gradual, LifeUnit::none, 0, 0.5,
             5},
    KindInfo{LifeKind::heater_loss, "heater_loss", Profile::gradual, LifeUnit::heater, 4, 0.5, 1},
    KindInfo{LifeKind::thermostat_shift, "thermostat_shift", Profile::gradual, LifeUnit::heater, 4,
             2, 20},
    KindInfo{LifeKind::bearing_wear, "bearing_wear", Profile::gradual, LifeUnit::wheel, 1, 0.5, 5},
    KindInfo{LifeKind::lubricant_loss, "lubricant_loss", Profile::gradual, LifeUnit::wheel, 1, 0.3,
             0.9},
    KindInfo{LifeKind::motor_fade, "motor_fade", Profile::gradual, LifeUnit::wheel, 1, 0.05, 0.5},
    KindInfo{LifeKind::gain_drop, "gain_drop", Profile::gradual, LifeUnit::none, 0, 1, 10},
    KindInfo{LifeKind::quiescent_growth, "quiescent_growth", Profile::gradual, LifeUnit::none, 0,
             0.3, 3},
    KindInfo{LifeKind::heater_stuck, "heater_stuck", Profile::mode, LifeUnit::heater, 4, 1, 1},
    KindInfo{LifeKind::redundant_thermostat, "redundant_thermostat", Profile::mode,
             LifeUnit::heater, 4, 1, 1},
    KindInfo{LifeKind::bearing_instability, "bearing_instability", Profile::mode, LifeUnit::wheel,
             1, 1, 5},
    KindInfo{LifeKind::redundant_amplifier, "redundant_amplifier", Profile::mode, LifeUnit::none, 0,
             1, 1},
};

const KindInfo& info(LifeKind kind) {
  return kinds[static_cast<std::size_t>(kind)];
}

int most_unit(LifeUnit unit) {
  switch (unit) {
    case LifeUnit::none:
      return 0;
    case LifeUnit::battery:
      return battery_count;
    case LifeUnit::section:
      return battery_count + 1;
    case LifeUnit::converter:
      return converter_count;
    case LifeUnit::string_row:
      return battery_count + shunt_channels;
    case LifeUnit::panel:
      return platform::panel_count;
    case LifeUnit::heater:
      return platform::heater_count;
    case LifeUnit::wheel:
      return platform::wheel_count;
  }
  return 0;
}

/// Whether an event of unit 0 or `unit` is meant.
bool concerns(const LifeEvent& event, std::size_t unit) {
  return event.unit == 0 || event.unit == static_cast<int>(unit);
}

void lose_strings(ArrayConstants& array, int row, int strings) {
  const auto index = static_cast<std::size_t>(row - 1);
  int& left = index < battery_count ? array.charge_strings[index]
                                    : array.bus_strings[index - battery_count];
  left = std::max(0, left - strings);
}

void apply(const LifeEvent& event, double grown, Constants& c) {
  const double change = event.magnitude * grown;
  switch (event.kind) {
    case LifeKind::array_degradation:
      for (std::size_t section = 0; section < section_count; ++section)
        if (concerns(event, section + 1)) c.array.section_share[section] *= 1 - change;
      break;
    case LifeKind::capacity_fade:
      for (std::size_t k = 0; k < battery_count; ++k)
        if (concerns(event, k + 1)) c.battery[k].capacity_Ah *= 1 - change;
      break;
    case LifeKind::rising_resistance:
      for (std::size_t k = 0; k < battery_count; ++k) {
        if (!concerns(event, k + 1)) continue;
        c.battery[k].series_ohm *= 1 + change;
        c.battery[k].fast_ohm *= 1 + change;
        c.battery[k].slow_ohm *= 1 + change;
      }
      break;
    case LifeKind::efficiency_drift:
      c.bdr.idle_W *= 1 + change;
      c.bdr.drop_V *= 1 + change;
      c.bdr.series_ohm *= 1 + change;
      c.bdr.switching *= 1 + change;
      break;
    case LifeKind::converter_drift:
      for (std::size_t l = 0; l < converter_count; ++l) {
        if (!concerns(event, l + 1)) continue;
        c.converter[l].idle_W *= 1 + change;
        c.converter[l].drop_V *= 1 + change;
        c.converter[l].series_ohm *= 1 + change;
      }
      break;
    case LifeKind::lost_string:
      if (grown > 0) lose_strings(c.array, event.unit, static_cast<int>(event.magnitude));
      break;
    case LifeKind::failed_cell:
      for (std::size_t k = 0; k < battery_count; ++k)
        if (grown > 0 && concerns(event, k + 1))
          c.battery[k].cells = std::max(1, c.battery[k].cells - static_cast<int>(event.magnitude));
      break;
    case LifeKind::redundant_charger:
      for (std::size_t k = 0; k < battery_count; ++k)
        if (grown > 0 && concerns(event, k + 1)) c.charger_in_use[k] = 1;
      break;
    case LifeKind::redundant_heater:
      for (std::size_t k = 0; k < battery_count; ++k)
        if (grown > 0 && concerns(event, k + 1)) c.load.heater_in_use[k] = 1;
      break;
    default:  // modes that the plan asks for, and what happens to the platform
      break;
  }
}

}  // namespace

std::string_view name(LifeKind kind) {
  return info(kind).name;
}

std::span<const LifeKind> life_kinds() {
  static constexpr auto list = [] {
    std::array<LifeKind, kinds.size()> result{};
    for (std::size_t i = 0; i < kinds.size(); ++i) result[i] = kinds[i].kind;
    return result;
  }();
  return list;
}

bool happens_to(Family family, LifeKind kind) {
  if (kind == LifeKind::safe_mode || kind == LifeKind::quiet) return true;
  return (family == Family::platform) == (kind >= LifeKind::paint_degradation);
}

LifeUnit unit_of(LifeKind kind) {
  return info(kind).unit;
}

LifeEvent usual(LifeKind kind, storage::Time begin, storage::Time end) {
  return {kind, begin, end, info(kind).usual_magnitude, info(kind).usual_unit};
}

std::string life_mistake(const LifeEvent& event) {
  const KindInfo& kind = info(event.kind);
  if (event.end < event.begin)
    return fmt::format("{} ends before it begins; write its times in their order", kind.name);
  if (kind.profile == Profile::step && event.end != event.begin)
    return fmt::format("{} happens at once; give one time", kind.name);
  const int least_unit = kind.unit == LifeUnit::string_row ? 1 : 0;
  if (event.unit < least_unit || event.unit > most_unit(kind.unit))
    return fmt::format("{} has units {} to {}, not {}", kind.name, least_unit, most_unit(kind.unit),
                       event.unit);
  if (!(event.magnitude > 0 && event.magnitude <= kind.most))
    return fmt::format("{} takes a magnitude above 0 and up to {}, not {}", kind.name, kind.most,
                       event.magnitude);
  if (kind.profile == Profile::step && event.magnitude != std::floor(event.magnitude))
    return fmt::format("{} takes a whole number, not {}", kind.name, event.magnitude);
  return {};
}

double progress(const LifeEvent& event, storage::Time time) {
  if (time < event.begin) return 0;
  if (event.begin == event.end) return 1;
  if (info(event.kind).profile == Profile::mode) return time < event.end ? 1 : 0;
  if (time >= event.end) return 1;
  return static_cast<double>(time - event.begin) / static_cast<double>(event.end - event.begin);
}

bool in_mode(std::span<const LifeEvent> life, LifeKind mode, storage::Time time) {
  return std::any_of(life.begin(), life.end(), [&](const LifeEvent& event) {
    return event.kind == mode && progress(event, time) > 0;
  });
}

Constants aged(const Constants& fresh, std::span<const LifeEvent> life, storage::Time time) {
  Constants constants = fresh;
  for (const LifeEvent& event : life) apply(event, progress(event, time), constants);
  return constants;
}

bool ages_between(std::span<const LifeEvent> life, storage::Time from, storage::Time to) {
  return std::any_of(life.begin(), life.end(), [&](const LifeEvent& event) {
    return progress(event, from) != progress(event, to);
  });
}

}  // namespace reident::satcs::reference
