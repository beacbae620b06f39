#include "service/satcs/platform/platform_life.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "service/satcs/platform/platform_spacecraft.hpp"
#include "service/satcs/reference/life_text.hpp"

namespace reident::satcs::platform::platform_life_test {
namespace {

using reference::LifeEvent;
using reference::LifeKind;

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z

struct Change {
  LifeEvent event;
  std::function<void(Constants&)> expected;
};

void wear(WheelConstants& wheel, double factor) {
  wheel.coulomb_Nm *= factor;
  wheel.viscous_Nms *= factor;
}

const std::vector<Change>& changes() {
  static const std::vector<Change> all{
      {{LifeKind::paint_degradation, 0, 100, 0.25, 3},
       [](Constants& c) { c.thermal.panel[sun_panel].absorptance += 0.25; }},
      {{LifeKind::interface_loss, 0, 100, 0.5, 0},
       [](Constants& c) { c.thermal.link[amplifier_link].conductance_W_K /= 2; }},
      {{LifeKind::insulation_loss, 0, 100, 0.5, 0},
       [](Constants& c) { c.thermal.tank_emitting_m2 *= 1.5; }},
      {{LifeKind::heater_loss, 0, 0, 1, 2}, [](Constants& c) { c.thermal.heater[1].share = 0; }},
      {{LifeKind::thermostat_shift, 0, 100, 2, 4},
       [](Constants& c) {
         for (auto& thermostat : c.thermal.heater[3].thermostat) {
           thermostat.on_C += 2;
           thermostat.off_C += 2;
         }
       }},
      {{LifeKind::bearing_wear, 0, 100, 1, 2}, [](Constants& c) { wear(c.wheel[1], 2); }},
      {{LifeKind::bearing_instability, 0, 0, 2, 3}, [](Constants& c) { wear(c.wheel[2], 3); }},
      {{LifeKind::lubricant_loss, 0, 100, 0.5, 1},
       [](Constants& c) {
         c.wheel[0].viscous_Nms *= 0.5;
         c.wheel[0].coulomb_Nm *= 2.5;
         c.wheel[0].stribeck_Nm *= 2.5;
       }},
      {{LifeKind::motor_fade, 0, 100, 0.25, 0},
       [](Constants& c) {
         for (WheelConstants& wheel : c.wheel) wheel.torque_Nm_A *= 0.75;
       }},
      {{LifeKind::gain_drop, 0, 100, 2, 0},
       [](Constants& c) {
         for (auto& amplifier : c.transmitter.amplifier) amplifier.gain_dB -= 2;
       }},
      {{LifeKind::quiescent_growth, 0, 100, 1, 0},
       [](Constants& c) {
         for (auto& amplifier : c.transmitter.amplifier) amplifier.quiescent_W *= 2;
       }},
      {{LifeKind::heater_stuck, 0, 0, 0.5, 1},
       [](Constants& c) { c.thermal.heater[0].stuck_share = 0.5; }},
      {{LifeKind::redundant_thermostat, 0, 0, 1, 4},
       [](Constants& c) { c.thermal.heater[3].in_use = 1; }},
      {{LifeKind::redundant_amplifier, 0, 0, 1, 0}, [](Constants& c) { c.transmitter.in_use = 1; }},
      {{LifeKind::safe_mode, 0, 0, 1, 0}, [](Constants&) {}},
      {{LifeKind::quiet, 0, 0, 1, 0}, [](Constants&) {}},
  };
  return all;
}

TEST(PlatformLife, EachKindChangesItsConstantsAndNoOthers) {
  std::set<LifeKind> seen, known;
  for (const auto& [event, change] : changes()) {
    Constants expected;
    change(expected);
    EXPECT_EQ(life_mistake(event), "");
    EXPECT_TRUE(aged(Constants{}, std::array{event}, event.end) == expected) << name(event.kind);
    // The power subsystem does not feel it.
    EXPECT_TRUE(reference::aged(reference::Constants{}, std::array{event}, event.end) ==
                reference::Constants{});
    seen.insert(event.kind);
  }
  for (const LifeKind kind : reference::life_kinds())
    if (happens_to(Family::platform, kind)) known.insert(kind);
  EXPECT_EQ(seen, known);
}

TEST(PlatformLife, OfThePowerSubsystemChangesNothing) {
  for (const LifeKind kind : reference::life_kinds()) {
    if (happens_to(Family::platform, kind)) continue;
    EXPECT_TRUE(happens_to(Family::power, kind));
    const std::array life{reference::usual(kind, 0, 0)};
    EXPECT_TRUE(aged(Constants{}, life, 0) == Constants{}) << name(kind);
  }
}

/// The points that differ between a platform with and one without an event at `at`, at most
/// `seconds` after it; before it, all are the same to the last bit.
std::set<std::string> differing(const LifeEvent& event, storage::Time at, int seconds) {
  const storage::Time begin = at - 30 * second;
  PlatformSpacecraft with({}, {event}, begin, 1);
  PlatformSpacecraft without({}, {}, begin, 1);
  std::set<std::string> names;
  for (int s = 0; s < 30 + seconds; ++s) {
    const auto a = with.noise_free();
    const auto b = without.noise_free();
    if (s <= 30) {
      EXPECT_EQ(a, b) << name(event.kind) << " at " << s;
    }
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::abs(a[i] - b[i]) > 1e-6) names.insert(std::string(telemetry_points()[i].name));
    with.advance();
    without.advance();
  }
  return names;
}

TEST(PlatformLife, TelemetryFeelsEachEventFromItsSecondOn) {
  const storage::Time at = july + 3000 * second;
  const std::map<LifeKind, std::vector<std::string>> felt{
      {LifeKind::paint_degradation, {"T_PZEN", "T_PNAD", "T_PSUN"}},
      {LifeKind::interface_loss, {"T_PA"}},
      {LifeKind::insulation_loss, {"T_TANK"}},
      {LifeKind::heater_loss, {"T_TANK", "I_H4", "I_HALL"}},
      {LifeKind::thermostat_shift, {"S_H4"}},
      {LifeKind::bearing_wear, {"W_RW1", "TQ_RW1", "IM_RW1", "I_RW1"}},
      {LifeKind::lubricant_loss, {"W_RW1", "TQ_RW1"}},
      {LifeKind::motor_fade, {"W_RW1", "TQ_RW1"}},
      {LifeKind::gain_drop, {"P_PA", "I_PA"}},
      {LifeKind::quiescent_growth, {"I_PA", "I_PAD", "T_PA"}},
      {LifeKind::heater_stuck, {"I_H4", "T_TANK"}},
      {LifeKind::redundant_thermostat, {"S_H4R"}},
      {LifeKind::bearing_instability, {"W_RW1"}},
      {LifeKind::redundant_amplifier, {"S_PAR", "P_PA", "I_PA"}},
      {LifeKind::safe_mode, {"S_PSAFE", "I_ELEC"}},
  };
  for (const auto& [kind, names] : felt) {
    const auto differ = differing(reference::usual(kind, at, at), at, 6016);
    for (const std::string& one : names) EXPECT_TRUE(differ.count(one)) << name(kind) << " " << one;
  }
  const auto second_wheel = differing({LifeKind::bearing_wear, at, at, 1, 2}, at, 60);
  EXPECT_TRUE(second_wheel.count("W_RW2"));
  EXPECT_FALSE(second_wheel.count("W_RW1"));
}

TEST(PlatformLife, IsWrittenAsTheLifeOfThePowerSubsystem) {
  const auto parsed = parse_life_event("thermostat_shift@+1h*3#2", july);
  const LifeEvent event = std::get<LifeEvent>(parsed);
  EXPECT_EQ(event.kind, LifeKind::thermostat_shift);
  EXPECT_EQ(event.magnitude, 3);
  EXPECT_EQ(event.unit, 2);
  EXPECT_NE(std::get<LifeError>(parse_life_event("bearing_wear@+1h#4", july))
                .message.find("units 0 to 3"),
            std::string::npos);
}

}  // namespace
}  // namespace reident::satcs::platform::platform_life_test
