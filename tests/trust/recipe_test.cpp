#include "tests/trust/recipe.hpp"

#include <set>

#include <gmock/gmock.h>

#include "service/satcs/reference/life_text.hpp"
#include "service/support/time_text.hpp"
#include "tests/trust/suite_config.hpp"

namespace reident::trust::recipe_test {
namespace {

using satcs::Fault;
using satcs::reference::LifeEvent;

bool same(const LifeEvent& a, const LifeEvent& b) {
  return a.kind == b.kind && a.begin == b.begin && a.end == b.end && a.magnitude == b.magnitude &&
         a.unit == b.unit;
}

bool same(const Fault& a, const Fault& b) {
  return a.kind == b.kind && a.when == b.when && a.parameter == b.parameter && a.other == b.other &&
         a.magnitude == b.magnitude && a.seed == b.seed;
}

std::vector<std::string> values_of(const std::string& option,
                                   const std::vector<std::string>& arguments) {
  std::vector<std::string> values;
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i)
    if (arguments[i] == option) values.push_back(arguments[i + 1]);
  return values;
}

TEST(Recipe, GivesEveryScenarioBackToTheLastBit) {
  std::vector<LifeGroup> groups = all_groups(suite_config().spacecraft.front());
  groups.push_back(short_group());
  using enum satcs::Family;
  for (LifeGroup& group : all_groups(suite_config(platform).spacecraft.front(), 0, platform))
    groups.push_back(std::move(group));
  for (const LifeGroup& group : groups)
    for (const Scenario& scenario : group.scenarios) {
      const Recipe recipe = recipe_of(group, scenario);
      for (const auto& arguments : {recipe.simulator, recipe.spacecraft}) {
        const auto family = values_of("--family", arguments);
        EXPECT_EQ(family.empty() ? "power" : family.front(), name(group.family));
        EXPECT_EQ(parse_time(values_of("--start", arguments).at(0)), group.start);
        EXPECT_EQ(values_of("--seed", arguments).at(0), std::to_string(group.seed));
        const auto life = values_of("--life", arguments);
        ASSERT_EQ(life.size(), group.events.size());
        for (std::size_t i = 0; i < life.size(); ++i)
          EXPECT_TRUE(
              same(std::get<LifeEvent>(satcs::parse_life_event(life[i], 0)), group.events[i]))
              << life[i];
      }
      EXPECT_EQ(parse_duration(values_of("--duration", recipe.spacecraft).at(0)), group.duration);
      EXPECT_TRUE(values_of("--fault", recipe.simulator).empty());
      const auto faults = values_of("--fault", recipe.spacecraft);
      ASSERT_EQ(faults.size(), scenario.faults.size());
      for (std::size_t i = 0; i < faults.size(); ++i)
        EXPECT_TRUE(same(std::get<Fault>(satcs::parse_fault(faults[i], 0)), scenario.faults[i]))
            << faults[i];
    }
}

TEST(Recipe, HasAConfigurationOfTheGroupsEquipmentAlone) {
  const auto parsed = parse_config(suite_toml({"CHC1"}), {});
  const SpacecraftConfig& spacecraft = std::get<Config>(parsed).spacecraft.front();
  const Config whole = suite_config();
  ASSERT_EQ(spacecraft.equipment.size(), 1U);
  EXPECT_EQ(spacecraft.equipment[0].name, "CHC1");
  EXPECT_EQ(spacecraft.equipment[0].sample_period, suite_period);
  EXPECT_EQ(spacecraft.equipment[0].max_order, 6);
  EXPECT_EQ(spacecraft.relations, whole.spacecraft.front().relations);
}

TEST(Recipe, HasTheKeysThatAreSetInEveryEquipment) {
  const auto keys = "bias = \"approve\"\nmargin = 5";
  for (const EquipmentConfig& equipment :
       suite_config(satcs::Family::power, keys).spacecraft[0].equipment) {
    EXPECT_EQ(equipment.bias, BiasPolicy::approve);
    EXPECT_EQ(equipment.margin_percent, 5);
  }
  EXPECT_THROW(suite_toml({}, satcs::Family::power, "bias"), std::exception);
}

TEST(Recipe, HasThePlatformsConfigurationForThePlatform) {
  const auto parsed = parse_config(suite_toml({"TANK"}, satcs::Family::platform), {});
  const Config& config = std::get<Config>(parsed);
  EXPECT_EQ(config.database, "reference.db");
  const SpacecraftConfig& spacecraft = config.spacecraft.front();
  EXPECT_EQ(spacecraft.name, "PLATFORM");
  ASSERT_EQ(spacecraft.equipment.size(), 1U);
  EXPECT_EQ(spacecraft.equipment[0].sample_period, platform_period);
}

TEST(Handful, IsOfDifferentLivesAndFaults) {
  std::set<std::string> lives, faults;
  std::size_t scenarios = 0;
  for (const LifeGroup& group : all_groups(suite_config().spacecraft.front()))
    for (const Scenario& scenario : group.scenarios) {
      if (!is_of_the_handful(scenario)) continue;
      lives.insert(group.life);
      faults.insert(scenario.fault);
      ++scenarios;
    }
  EXPECT_EQ(scenarios, 5U);
  EXPECT_EQ(lives.size(), scenarios);
  EXPECT_GE(faults.size(), 4U);
}

}  // namespace
}  // namespace reident::trust::recipe_test
