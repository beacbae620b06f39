#include "service/satcs/reference/reference_life.hpp"

#include <functional>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "service/satcs/reference/life_text.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::satcs::reference::reference_life_test {
namespace {

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time hour = 3600 * second;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z
constexpr storage::Time sunlit = july - 1200 * second;  // and the batteries are all but full

Constants after(const LifeEvent& event) {
  return aged(Constants{}, std::array{event}, event.end);
}

struct Change {
  LifeEvent event;
  std::function<void(Constants&)> expected;
};

const std::vector<Change>& changes() {
  static const std::vector<Change> all{
      {{LifeKind::array_degradation, 0, 100, 0.25, 1},
       [](Constants& c) { c.array.section_share[0] = 0.75; }},
      {{LifeKind::array_degradation, 0, 0, 0.5, 0},
       [](Constants& c) {
         c.array.section_share = {0.5, 0.5, 0.5};
       }},
      {{LifeKind::capacity_fade, 0, 100, 0.5, 2},
       [](Constants& c) { c.battery[1].capacity_Ah /= 2; }},
      {{LifeKind::rising_resistance, 0, 100, 1, 1},
       [](Constants& c) {
         c.battery[0].series_ohm *= 2;
         c.battery[0].fast_ohm *= 2;
         c.battery[0].slow_ohm *= 2;
       }},
      {{LifeKind::efficiency_drift, 0, 100, 1, 0},
       [](Constants& c) {
         c.bdr.idle_W *= 2;
         c.bdr.drop_V *= 2;
         c.bdr.series_ohm *= 2;
         c.bdr.switching *= 2;
       }},
      {{LifeKind::converter_drift, 0, 100, 1, 3},
       [](Constants& c) {
         c.converter[2].idle_W *= 2;
         c.converter[2].drop_V *= 2;
         c.converter[2].series_ohm *= 2;
       }},
      {{LifeKind::lost_string, 0, 0, 2, 2}, [](Constants& c) { c.array.charge_strings[1] -= 2; }},
      {{LifeKind::lost_string, 0, 0, 13, 8}, [](Constants& c) { c.array.bus_strings[5] -= 13; }},
      {{LifeKind::failed_cell, 0, 0, 1, 2}, [](Constants& c) { c.battery[1].cells -= 1; }},
      {{LifeKind::redundant_charger, 0, 0, 1, 2}, [](Constants& c) { c.charger_in_use[1] = 1; }},
      {{LifeKind::redundant_heater, 0, 0, 1, 0},
       [](Constants& c) {
         c.load.heater_in_use = {1, 1};
       }},
      {{LifeKind::safe_mode, 0, 0, 1, 0}, [](Constants&) {}},
      {{LifeKind::quiet, 0, 0, 1, 0}, [](Constants&) {}},
  };
  return all;
}

TEST(ReferenceLife, EachKindChangesItsConstantsAndNoOthers) {
  std::set<LifeKind> seen, known;
  for (const auto& [event, change] : changes()) {
    Constants expected;
    change(expected);
    EXPECT_EQ(life_mistake(event), "");
    EXPECT_TRUE(after(event) == expected) << name(event.kind);
    seen.insert(event.kind);
  }
  for (const LifeKind kind : life_kinds())
    if (happens_to(Family::power, kind)) known.insert(kind);
  EXPECT_EQ(seen, known);
}

TEST(ReferenceLife, GradualChangesGrowLinearlyAndStay) {
  const std::array life{LifeEvent{LifeKind::capacity_fade, july, july + 10 * hour, 0.2, 1}};
  const auto lost = [&](storage::Time time) {
    return 1 - aged(Constants{}, life, time).battery[0].capacity_Ah / 50;
  };
  EXPECT_EQ(lost(july), 0);
  EXPECT_NEAR(lost(july + 5 * hour), 0.1, 1e-12);
  EXPECT_NEAR(lost(july + 10 * hour), 0.2, 1e-12);
  EXPECT_NEAR(lost(july + 99 * hour), 0.2, 1e-12);
  EXPECT_TRUE(ages_between(life, july, july + second));
  EXPECT_FALSE(ages_between(life, july + 10 * hour, july + 11 * hour));
}

TEST(ReferenceLife, ModesEndAndEventsAddUp) {
  const std::array life{LifeEvent{LifeKind::redundant_charger, july, july + hour, 1, 1},
                        LifeEvent{LifeKind::failed_cell, july, july, 1, 1},
                        LifeEvent{LifeKind::failed_cell, july + hour, july + hour, 1, 1}};
  EXPECT_EQ(aged(Constants{}, life, july).charger_in_use[0], 1U);
  EXPECT_EQ(aged(Constants{}, life, july + hour).charger_in_use[0], 0U);
  EXPECT_EQ(aged(Constants{}, life, july + hour).battery[0].cells, 36);
}

/// The points that differ by more than `least` between a spacecraft with and one without an event
/// at sunlit + 60 s, at most `seconds` after it; before it, all are the same to the last bit.
std::set<std::string> differing(const LifeEvent& event, int seconds, double least = 1e-9) {
  Spacecraft with(Constants{}, {event}, sunlit, 1);
  Spacecraft without(Constants{}, {}, sunlit, 1);
  std::set<std::string> names;
  for (int s = 0; s < 60 + seconds; ++s) {
    const auto a = with.noise_free();
    const auto b = without.noise_free();
    if (s <= 60) {
      EXPECT_EQ(a, b) << name(event.kind) << " at " << s;
    }
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::abs(a[i] - b[i]) > least) names.insert(std::string(telemetry_points()[i].name));
    with.advance();
    without.advance();
  }
  return names;
}

TEST(ReferenceLife, TelemetryFeelsEachEventFromItsSecondOn) {
  const storage::Time at = sunlit + 60 * second;
  const std::map<LifeKind, std::vector<std::string>> felt{
      {LifeKind::array_degradation, {"I_SAG1A", "I_SAG1B", "I_SAG2", "I_SHUNT", "V_MEA"}},
      {LifeKind::capacity_fade, {"V_BAT1", "V_BAT2"}},
      {LifeKind::rising_resistance, {"V_BAT1", "V_BDRIN2"}},
      {LifeKind::efficiency_drift, {"I_BDRIN1", "I_BDRIN2", "I_BAT1"}},
      {LifeKind::converter_drift, {"I_DC1IN", "I_DC2IN", "I_DC3IN", "I_DIST"}},
      {LifeKind::lost_string, {"I_SAG2", "I_SHUNT"}},
      {LifeKind::failed_cell, {"V_BAT1", "V_CHC1", "V_SAG1A"}},
      {LifeKind::redundant_charger, {"S_CHC1R", "I_SGBCHC", "I_CSH1"}},
      {LifeKind::redundant_heater, {"S_BHC1R"}},
      {LifeKind::safe_mode, {"S_SAFE", "I_PF", "I_DC3OUT", "I_BUS"}},
  };
  for (const auto& [kind, names] : felt) {
    const auto differ = differing(usual(kind, at, at), 30);
    for (const std::string& one : names) EXPECT_TRUE(differ.count(one)) << name(kind) << " " << one;
  }
  const auto second_string = differing({LifeKind::lost_string, at, at, 1, 2}, 30, 0.1);
  EXPECT_TRUE(second_string.count("I_SAG1B"));
  EXPECT_FALSE(second_string.count("I_SAG1A"));
  EXPECT_FALSE(second_string.count("I_SAG2"));
  const auto first_battery = differing({LifeKind::failed_cell, at, at, 1, 1}, 1);
  EXPECT_FALSE(first_battery.count("V_BAT2"));
}

TEST(ReferenceLife, ModesSwitchTheLoadsOff) {
  const Orbit orbit{OrbitConstants{}};
  const auto on = [&](std::vector<LifeEvent> life) {
    const OperationsPlan plan(orbit, LoadConstants{}, std::move(life), 3);
    int seconds = 0;
    for (int s = 0; s < 86'400; s += 10) {
      const auto now = plan.at(july + s * second);
      seconds += now.payload || now.transmitter ? 10 : 0;
    }
    return seconds;
  };
  EXPECT_GT(on({}), 3600);
  EXPECT_EQ(on({usual(LifeKind::quiet, july, july + 24 * hour)}), 0);
  EXPECT_EQ(on({usual(LifeKind::safe_mode, july, july)}), 0);
  const int half = on({usual(LifeKind::quiet, july, july + 12 * hour)});
  EXPECT_GT(half, 0);
  EXPECT_LT(half, on({}));
}

TEST(ReferenceLife, WornOutSpacecraftStaysFinite) {
  const storage::Time at = sunlit + 600 * second;
  Plant plant(Constants{},
              {{LifeKind::capacity_fade, at, at, 0.9, 0},
               {LifeKind::failed_cell, at, at, 10, 1},
               {LifeKind::rising_resistance, at, at, 3, 0},
               {LifeKind::array_degradation, at, at + hour, 0.9, 0},
               {LifeKind::efficiency_drift, at, at, 3, 0}},
              sunlit, 1);
  for (int step = 0; step < 4 * 6016 * Plant::usual_steps_per_second; ++step) {
    plant.step();
    const PowerBalance p = plant.power_balance();
    ASSERT_GE(plant.flows().bus_V, Constants{}.bus.fold_back_V - 1e-9);
    ASSERT_GT(plant.flows().battery_V[0], 0);
    ASSERT_NEAR(p.array, p.use() + p.losses() + p.stored(), 1e-9);
  }
}

TEST(LifeText, GivesTheEventThatItNames) {
  const auto parsed = [](std::string_view text) {
    return std::get<LifeEvent>(parse_life_event(text, july));
  };
  const LifeEvent fade = parsed("capacity_fade@+1h/2017-07-02*0.15#2");
  EXPECT_EQ(fade.kind, LifeKind::capacity_fade);
  EXPECT_EQ(fade.begin, july + hour);
  EXPECT_EQ(fade.end, july + 24 * hour);
  EXPECT_EQ(fade.magnitude, 0.15);
  EXPECT_EQ(fade.unit, 2);
  const LifeEvent usual_cell = parsed("failed_cell@2017-07-01T01:00:00Z");
  EXPECT_EQ(usual_cell.begin, usual_cell.end);
  EXPECT_EQ(usual_cell.magnitude, 1);
  EXPECT_EQ(usual_cell.unit, 1);
}

TEST(LifeText, SaysWhatIsWrong) {
  const std::map<std::string, std::string> wrong{
      {"capacity_fade", "KIND@TIME"},
      {"wear@+1h", "there is no event 'wear'; the events are: array_degradation"},
      {"quiet@yesterday", "'yesterday' is neither a time"},
      {"capacity_fade@+1h*much", "'much' is not a number"},
      {"capacity_fade@+1h*1.5", "a magnitude above 0 and up to 0.9"},
      {"capacity_fade@+2h/+1h", "ends before it begins"},
      {"lost_string@+1h/+2h", "happens at once"},
      {"lost_string@+1h#0", "units 1 to 8"},
      {"failed_cell@+1h*0.5", "a whole number"},
      {"failed_cell@+1h#x", "not the number of a unit"},
  };
  for (const auto& [text, message] : wrong) {
    const auto parsed = parse_life_event(text, july);
    ASSERT_TRUE(std::holds_alternative<LifeError>(parsed)) << text;
    EXPECT_NE(std::get<LifeError>(parsed).message.find(message), std::string::npos)
        << std::get<LifeError>(parsed).message;
  }
}

}  // namespace
}  // namespace reident::satcs::reference::reference_life_test
