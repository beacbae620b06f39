#include "tests/trust/scenario.hpp"

#include <map>
#include <set>

#include <gmock/gmock.h>

#include "service/satcs/reference/reference_telemetry.hpp"
#include "tests/trust/suite_config.hpp"

namespace reident::trust::scenario_test {
namespace {

TEST(Scenarios, AreManyAndNumberedOnce) {
  std::set<int> numbers;
  std::size_t scenarios = 0;
  for (const LifeGroup& group : all_groups(suite_config().spacecraft.front()))
    for (const Scenario& scenario : group.scenarios) {
      numbers.insert(scenario.number);
      ++scenarios;
    }
  EXPECT_GE(scenarios, 300U);
  EXPECT_EQ(numbers.size(), scenarios);
}

TEST(Scenarios, HaveEveryLifeAndEveryFaultInBothHalves) {
  std::map<Half, std::set<satcs::reference::LifeKind>> lives;
  std::map<Half, std::set<std::string>> faults;
  for (const LifeGroup& group : all_groups(suite_config().spacecraft.front())) {
    for (const auto& event : group.events) lives[group.half()].insert(event.kind);
    for (const Scenario& scenario : group.scenarios) faults[group.half()].insert(scenario.fault);
  }
  std::set<satcs::reference::LifeKind> of_power;
  for (const auto kind : satcs::reference::life_kinds())
    if (happens_to(satcs::Family::power, kind)) of_power.insert(kind);
  for (const Half half : {Half::tuned, Half::held_out}) {
    EXPECT_EQ(lives[half], of_power);
    EXPECT_EQ(faults[half].size(), satcs::fault_kinds + 1);  // and none
  }
}

TEST(Scenarios, OfAnotherDrawAreThoseOfTheTunedHalfAtOtherTimes) {
  const SpacecraftConfig spacecraft = suite_config().spacecraft.front();
  const auto suite = all_groups(spacecraft), drawn = all_groups(spacecraft, 3);
  std::set<std::uint64_t> seeds;
  for (const LifeGroup& group : suite) seeds.insert(group.seed);
  ASSERT_EQ(2 * drawn.size(), suite.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_EQ(drawn[i].half(), Half::tuned);
    EXPECT_FALSE(seeds.contains(drawn[i].seed));
    EXPECT_EQ(drawn[i].life, suite[i].life);
    EXPECT_EQ(drawn[i].scenarios.front().number, suite[i].scenarios.front().number);
    if (!drawn[i].events.empty()) {
      EXPECT_NE(drawn[i].events.front().begin, suite[i].events.front().begin);
    }
  }
}

TEST(Scenarios, CanHappen) {
  const auto descriptors = satcs::reference::telemetry_descriptors("REFERENCE");
  for (const LifeGroup& group : all_groups(suite_config().spacecraft.front())) {
    for (const auto& event : group.events) EXPECT_EQ(life_mistake(event), "") << group.life;
    for (const Scenario& scenario : group.scenarios)
      for (const satcs::Fault& fault : scenario.faults) {
        const auto why = obstacle(fault, descriptors);
        EXPECT_FALSE(why) << scenario.number << ": " << why->message;
      }
  }
}

TEST(Scenarios, AreTheSameEachTime) {
  const auto one = all_groups(suite_config().spacecraft.front());
  const auto two = all_groups(suite_config().spacecraft.front());
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].start, two[i].start);
    for (std::size_t k = 0; k < one[i].scenarios.size(); ++k)
      for (std::size_t l = 0; l < one[i].scenarios[k].faults.size(); ++l)
        EXPECT_EQ(one[i].scenarios[k].faults[l].when, two[i].scenarios[k].faults[l].when);
  }
}

}  // namespace
}  // namespace reident::trust::scenario_test
