#include "storage/registry/registry.hpp"
#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::registry_notices_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const EquipmentName bdr{"CB4", "BDR"};
const EquipmentName nobody{"", ""};

TEST_F(RegistryTest, AnAlarmIsRaisedOnceUntilItIsCleared) {
  registry.raise({"no_telemetry", bdr, "None since noon.", 10});
  registry.raise({"no_telemetry", bdr, "None since noon.", 20});
  registry.raise({"clock", nobody, "An hour off.", 30});
  const std::vector<Alarm> alarms = registry.alarms();
  ASSERT_THAT(alarms, SizeIs(2));
  EXPECT_EQ(alarms[0].code, "clock");
  EXPECT_EQ(alarms[1].about, bdr);
  EXPECT_EQ(alarms[1].since, 10);
  registry.clear("no_telemetry", bdr, 40);
  registry.clear("no_telemetry", bdr, 41);
  EXPECT_THAT(registry.alarms(), SizeIs(1));
  registry.raise({"no_telemetry", bdr, "None since noon.", 50});
  EXPECT_EQ(registry.alarms()[1].since, 50);
  EXPECT_THAT(rows(path, "SELECT kind, time FROM alarm WHERE code = 'no_telemetry' ORDER BY id"),
              ElementsAre("raise|10", "clear|40", "raise|50"));
}

TEST_F(RegistryTest, AnAlarmThatSaysSomethingElseStaysRaisedAndWaitsToBeSeenAgain) {
  registry.raise({"disk", nobody, "1 GiB is left.", 10});
  EXPECT_TRUE(registry.acknowledge("disk", nobody, "Ana", "ordered", 15));
  EXPECT_EQ(registry.alarms()[0].acknowledged_by, "Ana");
  registry.raise({"disk", nobody, "Nothing is left.", 20});
  EXPECT_EQ(registry.alarms()[0].text, "Nothing is left.");
  EXPECT_EQ(registry.alarms()[0].since, 10);
  EXPECT_EQ(registry.alarms()[0].acknowledged_by, "");
  EXPECT_FALSE(registry.acknowledge("damage", nobody, "Ana", "", 25));
}

TEST_F(RegistryTest, AChangeIsRecordedOnce) {
  EXPECT_FALSE(registry.last_change(bdr));
  version(10, DecisionKind::approve);
  registry.record_change(bdr, {1, 100, 160}, 170);
  registry.record_change(bdr, {1, 100, 160}, 180);
  registry.record_change(bdr, {1, 200, 260}, 270);
  EXPECT_EQ(registry.last_change(bdr)->since, 200);
  EXPECT_EQ(registry.last_change(bdr)->found, 260);
  EXPECT_THAT(rows(path, "SELECT time FROM change"), ElementsAre("170", "270"));
}

TEST_F(RegistryTest, TheLastRowOfASimulatorIsWhatItDoes) {
  SimulatorState state;
  state.simulator = "trainer-1";
  state.equipment = bdr;
  state.version = 3;
  state.mode = "following";
  state.process = UINT64_MAX;
  state.time = 10;
  registry.record_simulator(state);
  state.version = 4;
  state.error_before_percent = 1.25;
  state.time = 20;
  registry.record_simulator(state);
  ASSERT_THAT(registry.simulators(), SizeIs(1));
  EXPECT_EQ(registry.simulators()[0].version, 4);
  EXPECT_EQ(registry.simulators()[0].process, UINT64_MAX);
  state.is_there = false;
  registry.record_simulator(state);
  EXPECT_THAT(registry.simulators(), IsEmpty());
  EXPECT_THAT(rows(path, "SELECT version, error_before, is_there FROM simulator"),
              ElementsAre("3|NULL|1", "4|1.25|1", "4|1.25|0"));
}

TEST_F(RegistryTest, WhatWasNoticedIsNeverChanged) {
  version(10, DecisionKind::approve);
  registry.raise({"clock", nobody, "An hour off.", 30});
  registry.record_change(bdr, {1, 100, 160}, 170);
  registry.record_simulator({});
  for (const std::string table : {"alarm", "change", "simulator"}) {
    EXPECT_THAT(rows(path, "DELETE FROM " + table), ElementsAre(HasSubstr(" are never ")));
    EXPECT_THAT(rows(path, "UPDATE " + table + " SET time = 0"),
                ElementsAre(HasSubstr(" are never ")));
  }
}

std::vector<std::int64_t> versions_of(const std::vector<Decision>& decisions) {
  std::vector<std::int64_t> versions;
  for (const Decision& decision : decisions) versions.push_back(decision.version);
  return versions;
}

TEST_F(RegistryTest, WaitsAreThoseThatSayWhyAndWereNotAnsweredSince) {
  const NewDecision why{DecisionKind::wait, "gate", "held", R"({"reasons":[{"code":"held"}]})"};
  for (int i = 1; i <= 4; ++i) version(10 * i, DecisionKind::wait);
  registry.decide("CB4", "BDR", 1, why, 50);
  registry.decide("CB4", "BDR", 3, why, 60);
  registry.decide("CB4", "BDR", 4, why, 70);
  EXPECT_THAT(versions_of(registry.waits()), ElementsAre(1, 3, 4));
  registry.decide("CB4", "BDR", 3, {DecisionKind::reject, "Ana", "no"}, 80);
  EXPECT_THAT(versions_of(registry.waits()), ElementsAre(1, 4));
  NewAttempt older = attempt(90);
  older.outcome = "unvouched";  // as programs before version 0.2 said
  registry.record(older, {"{}", "d5"}, {DecisionKind::wait, "gate", "ask"});
  EXPECT_THAT(versions_of(registry.waits()), ElementsAre(1, 4, 5));
}

TEST_F(RegistryTest, CountsWhatThereIsAndGivesTheNewestBlocks) {
  version(10, DecisionKind::approve);
  version(20, DecisionKind::approve);
  decide(1, DecisionKind::roll_back, 30);
  registry.record(attempt(40));
  const Registry::Counts counts = registry.counts(bdr);
  EXPECT_EQ(counts.attempts, 3);
  EXPECT_EQ(counts.versions, 2);
  EXPECT_EQ(counts.approvals, 2);
  for (Time begin = 0; begin < 50; begin += 10) {
    Block block;
    block.range = {begin, begin + 10};
    registry.record_scores("CB4", "BDR", block, {});
  }
  const std::vector<Block> newest = registry.newest_blocks(bdr, 2);
  ASSERT_THAT(newest, SizeIs(2));
  EXPECT_EQ(newest[0].range.begin, 30);
  EXPECT_EQ(newest[1].range.begin, 40);
}

}  // namespace
}  // namespace reident::storage::test::registry_notices_test
