#include "tests/trust/scenario.hpp"

#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "service/satcs/family.hpp"
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

TEST(Scenarios, HaveEveryLifeAndEveryFault) {
  std::set<satcs::reference::LifeKind> lives, of_power;
  std::set<std::string> faults;
  for (const LifeGroup& group : all_groups(suite_config().spacecraft.front())) {
    for (const auto& event : group.events) lives.insert(event.kind);
    for (const Scenario& scenario : group.scenarios) faults.insert(scenario.fault);
  }
  for (const auto kind : satcs::reference::life_kinds())
    if (happens_to(satcs::Family::power, kind)) of_power.insert(kind);
  EXPECT_EQ(lives, of_power);
  EXPECT_EQ(faults.size(), satcs::fault_kinds + 1);  // and none
}

TEST(Scenarios, OfAnotherDrawAreTheSameAtOtherTimes) {
  const SpacecraftConfig spacecraft = suite_config().spacecraft.front();
  const auto suite = all_groups(spacecraft), drawn = all_groups(spacecraft, 3);
  std::set<std::uint64_t> seeds;
  for (const LifeGroup& group : suite) seeds.insert(group.seed);
  ASSERT_EQ(drawn.size(), suite.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_FALSE(seeds.contains(drawn[i].seed));
    EXPECT_EQ(drawn[i].life, suite[i].life);
    EXPECT_EQ(drawn[i].scenarios.front().number, suite[i].scenarios.front().number);
    if (!drawn[i].events.empty()) {
      EXPECT_NE(drawn[i].events.front().begin, suite[i].events.front().begin);
    }
  }
}

std::vector<LifeGroup> platform_groups(std::uint64_t draw = 0) {
  using enum satcs::Family;
  return all_groups(suite_config(platform).spacecraft.front(), draw, platform);
}

TEST(PlatformScenarios, AreManyAndOthersInEachDraw) {
  std::set<int> numbers;
  std::set<std::uint64_t> seeds;
  std::size_t scenarios = 0;
  for (const std::uint64_t draw : {0U, 4U})
    for (const LifeGroup& group : platform_groups(draw)) {
      EXPECT_TRUE(seeds.insert(group.seed).second);
      if (draw > 0) continue;
      for (const Scenario& scenario : group.scenarios) {
        EXPECT_GT(scenario.number, platform_numbers);
        numbers.insert(scenario.number);
        ++scenarios;
      }
    }
  EXPECT_GE(scenarios, 150U);
  EXPECT_EQ(numbers.size(), scenarios);
}

TEST(PlatformScenarios, HaveEveryLifeEveryFaultAndEveryEquipment) {
  std::set<satcs::reference::LifeKind> lives, of_platform;
  std::set<std::string> faults, equipment;
  for (const LifeGroup& group : platform_groups()) {
    for (const auto& event : group.events) lives.insert(event.kind);
    for (const Scenario& scenario : group.scenarios) faults.insert(scenario.fault);
    equipment.insert(group.equipment.begin(), group.equipment.end());
  }
  for (const auto kind : satcs::reference::life_kinds())
    if (happens_to(satcs::Family::platform, kind)) of_platform.insert(kind);
  EXPECT_EQ(lives, of_platform);
  EXPECT_EQ(faults.size(), satcs::fault_kinds + 1);  // and none
  EXPECT_EQ(equipment.size(),
            suite_config(satcs::Family::platform).spacecraft.front().equipment.size());
}

/// How many biases of so many days lie on the change, and apart from it.
std::pair<int, int> biases_of(double days) {
  constexpr Duration day = 86'400'000'000'000;
  std::pair<int, int> count;
  for (const LifeGroup& group : platform_groups())
    for (const Scenario& scenario : group.scenarios)
      for (const satcs::Fault& fault : scenario.faults) {
        const auto lasts = static_cast<double>(fault.when.end - fault.when.begin);
        if (fault.kind != satcs::FaultKind::bias_step || group.events.empty() ||
            std::abs(lasts / static_cast<double>(day) - days) > 1e-3)
          continue;
        const storage::Time change = group.events.front().begin;
        const bool on = fault.when.begin < change && change < fault.when.end;
        (on ? count.first : count.second) += 1;
      }
  return count;
}

TEST(PlatformScenarios, HaveBiasesOfADayAndOfFourDaysOnTheChangeAndApart) {
  for (const double days : {1.0, 4.0}) {
    EXPECT_GE(biases_of(days).first, 10) << days;
    EXPECT_GE(biases_of(days).second, 10) << days;
  }
}

TEST(Scenarios, CanHappen) {
  std::vector<storage::ParameterDescriptor> descriptors;
  std::vector<LifeGroup> groups;
  for (const auto family : {satcs::Family::power, satcs::Family::platform}) {
    for (auto& d : satcs::family_descriptors(family, "S")) descriptors.push_back(std::move(d));
    for (LifeGroup& group : all_groups(suite_config(family).spacecraft.front(), 0, family))
      groups.push_back(std::move(group));
  }
  for (const LifeGroup& group : groups) {
    for (const auto& event : group.events) {
      EXPECT_EQ(life_mistake(event), "") << group.life;
      EXPECT_TRUE(happens_to(group.family, event.kind)) << group.life;
    }
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
