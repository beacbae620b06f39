// Withdrawal, lineage, holds, decisions whose ground changed, and commands that come twice.
#include <set>

#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::operator_decisions_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using enum DecisionKind;

class OperatorDecisions : public RegistryTest {
 protected:
  /// The previous champion's number, or 0.
  std::int64_t previous() const {
    const auto version = registry.previous_champion("CB4", "BDR");
    return version ? version->number : 0;
  }
  static Command approval_of(std::uint64_t request) {
    return {.requester = "console-1",
            .request = request,
            .action = "approve",
            .spacecraft = "CB4",
            .equipment = "BDR",
            .version = 1,
            .actor = "Ana",
            .reason = "fine"};
  }
  std::vector<std::int64_t> parents() const {
    std::vector<std::int64_t> parents;
    for (std::int64_t number = 1; registry.version("CB4", "BDR", number); ++number)
      parents.push_back(registry.version("CB4", "BDR", number)->parent.value_or(0));
    return parents;
  }
};

TEST_F(OperatorDecisions, WithdrawingTheChampionBringsThePreviousOneBackInOneStep) {
  version(10, approve);
  version(20, approve);
  decide(2, withdraw, 30);
  EXPECT_THAT(statuses(), ElementsAre("approved", "withdrawn"));
  EXPECT_EQ(champion_at(29), 2);
  EXPECT_EQ(champion_at(30), 1);
  const auto decisions = registry.decisions("CB4", "BDR");
  ASSERT_THAT(decisions, SizeIs(4));
  EXPECT_EQ(decisions[2].kind, withdraw);
  EXPECT_EQ(decisions[3].kind, roll_back);
  EXPECT_EQ(decisions[3].version, 1);
  EXPECT_EQ(decisions[3].actor, "Ana");
  EXPECT_EQ(decisions[3].time, 30);
  EXPECT_EQ(decisions[3].reason, "version 2 was withdrawn: because");
}

TEST_F(OperatorDecisions, WithdrawingTheOnlyChampionLeavesNone) {
  version(10, approve);
  decide(1, withdraw, 30);
  EXPECT_EQ(champion_at(29), 1);
  EXPECT_EQ(champion_at(30), 0);
  EXPECT_EQ(champion_at(std::nullopt), 0);
  EXPECT_THAT(registry.champions(), SizeIs(0));
  EXPECT_THAT(registry.decisions("CB4", "BDR"), SizeIs(2));
  version(40, approve);
  EXPECT_EQ(champion_at(39), 0);
  EXPECT_EQ(champion_at(40), 2);
}

TEST_F(OperatorDecisions, WithdrawingAnOlderVersionLeavesTheChampion) {
  version(10, approve);
  version(20, approve);
  decide(1, withdraw, 30);
  EXPECT_THAT(statuses(), ElementsAre("withdrawn", "approved"));
  EXPECT_EQ(champion_at(15), 1) << "it was champion then";
  EXPECT_EQ(champion_at(30), 2);
  EXPECT_EQ(previous(), 0);
}

TEST_F(OperatorDecisions, AChampionThatWasRolledBackFromDoesNotReturnByAWithdrawal) {
  version(10, approve);
  version(20, approve);
  decide(1, roll_back, 30);
  decide(1, withdraw, 40);
  EXPECT_EQ(champion_at(std::nullopt), 0);
  EXPECT_THAT(statuses(), ElementsAre("withdrawn", "superseded"));
}

TEST_F(OperatorDecisions, AWithdrawalCountsFromItsTimeWhenTheClockWasSetBack) {
  version(100, approve);
  decide(1, withdraw, 50);
  EXPECT_EQ(champion_at(100), 0);
  EXPECT_EQ(champion_at(60), 0);
  EXPECT_EQ(champion_at(std::nullopt), 0);
}

TEST_F(OperatorDecisions, AParentIsTheChampionThatAVersionWasJudgedAgainst) {
  version(10, approve);
  version(20, reject);
  version(30, approve);
  version(40, wait);
  decide(1, roll_back, 50);
  version(60, approve);  // 5, follows 1
  EXPECT_THAT(parents(), ElementsAre(0, 1, 1, 3, 1));
  decide(5, withdraw, 70);
  decide(3, roll_back, 80);
  EXPECT_THAT(parents(), ElementsAre(0, 1, 1, 3, 1)) << "what was, was";
}

TEST_F(OperatorDecisions, AVersionThatWaitsIsApprovedWhoeverIsChampionByThen) {
  version(10, approve);
  version(20, wait);
  version(30, wait);
  decide(2, approve, 40);
  decide(3, approve, 50);
  EXPECT_EQ(champion_at(std::nullopt), 3);
  EXPECT_THAT(parents(), ElementsAre(0, 1, 2)) << "the champion that it replaced";
}

TEST_F(OperatorDecisions, ASummaryIsTheVersionWithoutItsModel) {
  version(10, approve);
  version(20, wait);
  decide(1, withdraw, 30);
  const auto summaries = registry.summaries("CB4", "BDR");
  ASSERT_THAT(summaries, SizeIs(2));
  for (const VersionSummary& summary : summaries) {
    const auto version = registry.version("CB4", "BDR", summary.number);
    EXPECT_EQ(summary.status, version->status);
    EXPECT_EQ(summary.parent, version->parent);
  }
}

TEST_F(OperatorDecisions, EquipmentIsNamedOnce) {
  version(10, approve);
  version(20, approve);
  registry.record(attempt(30, {0, 100}, "BAT1"));
  EXPECT_THAT(registry.equipment(),
              ElementsAre(EquipmentName{"CB4", "BAT1"}, EquipmentName{"CB4", "BDR"}));
}

TEST_F(OperatorDecisions, AfterAWithdrawalWithoutSuccessorTheNextHasNoParent) {
  version(10, approve);
  decide(1, withdraw, 20);
  version(30, approve);
  EXPECT_THAT(parents(), ElementsAre(0, 0));
}

TEST_F(OperatorDecisions, ThePreviousChampionSkipsWhatWasWithdrawn) {
  for (const Time time : {10, 20, 30, 40}) version(time, approve);
  EXPECT_EQ(previous(), 3);
  decide(2, withdraw, 50);
  decide(3, withdraw, 60);
  EXPECT_EQ(previous(), 1);
  decide(1, roll_back, 70);
  EXPECT_EQ(previous(), 0) << "the first one has none before it";
  decide(4, roll_back, 80);
  EXPECT_EQ(previous(), 1);
}

TEST_F(OperatorDecisions, ADecisionFollowsFromTheStatusOrIsRefused) {
  version(10, approve);
  version(20, approve);
  version(30, reject);
  version(40, wait);
  version(50, approve);
  decide(2, withdraw, 60);
  ASSERT_THAT(statuses(),
              ElementsAre("superseded", "withdrawn", "rejected", "waiting", "approved"));
  const std::set<std::pair<std::int64_t, DecisionKind>> allowed{
      {1, roll_back}, {1, withdraw}, {4, approve}, {4, reject}, {4, wait}, {5, withdraw}};
  const std::size_t before = registry.decisions("CB4", "BDR").size();
  for (std::int64_t number = 1; number <= 5; ++number)
    for (const DecisionKind kind : {approve, reject, wait, roll_back, withdraw}) {
      if (allowed.contains({number, kind})) continue;
      EXPECT_THAT(
          error_of([&] { decide(number, kind, 70); }),
          AllOf(StartsWith("failed: "), HasSubstr(registry.version("CB4", "BDR", number)->status)))
          << number << " " << name(kind);
    }
  EXPECT_THAT(registry.decisions("CB4", "BDR"), SizeIs(before));
}

TEST_F(OperatorDecisions, AHoldLastsUntilItsRelease) {
  EXPECT_EQ(registry.hold("CB4", "BDR"), std::nullopt);
  registry.put_on_hold("CB4", "BDR", {"Ana", "training", 10});
  const auto hold = registry.hold("CB4", "BDR");
  ASSERT_TRUE(hold);
  EXPECT_EQ(hold->actor, "Ana");
  EXPECT_EQ(hold->reason, "training");
  EXPECT_EQ(hold->since, 10);
  EXPECT_EQ(registry.hold("CB4", "MEA"), std::nullopt);
  EXPECT_THAT(error_of([&] {
                registry.put_on_hold("CB4", "BDR", {"Bo", "", 20});
              }),
              HasSubstr("is held already"));
  registry.release("CB4", "BDR", {"Bo", "over", 30});
  EXPECT_EQ(registry.hold("CB4", "BDR"), std::nullopt);
  EXPECT_THAT(error_of([&] {
                registry.release("CB4", "BDR", {"Bo", "", 40});
              }),
              HasSubstr("is not held"));
  registry.put_on_hold("CB4", "BDR", {"Cy", "again", 50});
  EXPECT_EQ(registry.hold("CB4", "BDR")->actor, "Cy");
  EXPECT_THAT(rows(path, "SELECT kind, actor FROM hold; SELECT actor, since FROM hold_now"),
              ElementsAre("hold|Ana", "release|Bo", "hold|Cy", "Cy|50"));
}

TEST_F(OperatorDecisions, NothingIsRecordedOnAGroundThatChanged) {
  const auto record_on = [&](const DecisionState& state) {
    return registry.record_if(state, attempt(100), {"{}", "d"}, decision(approve));
  };
  const DecisionState nothing = registry.decision_state("CB4", "BDR");
  version(10, approve, "MEA");
  registry.put_on_hold("CB4", "MEA", {"Ana", "", 15});
  EXPECT_EQ(record_on(nothing), 1) << "another equipment is no ground of this one";
  EXPECT_EQ(record_on(nothing), std::nullopt) << "there is a champion now";
  const DecisionState first = registry.decision_state("CB4", "BDR");
  registry.put_on_hold("CB4", "BDR", {"Ana", "", 20});
  EXPECT_EQ(record_on(first), std::nullopt) << "held";
  registry.release("CB4", "BDR", {"Ana", "", 30});
  EXPECT_EQ(record_on(first), std::nullopt) << "it was held meanwhile";
  EXPECT_EQ(registry.version("CB4", "BDR", 2), std::nullopt);
  EXPECT_EQ(record_on(registry.decision_state("CB4", "BDR")), 2);
}

TEST_F(OperatorDecisions, ACommandThatComesTwiceHasItsEffectOnceAndTheSameReply) {
  version(10, wait);
  int runs = 0;
  const auto approval = [&] {
    ++runs;
    decide(1, approve, 20);
    return CommandOutcome{true, "approved"};
  };
  Command command = approval_of(0xffffffffffffffff);
  for (const Time time : {20, 30}) {
    const CommandOutcome outcome = registry.execute(command, time, approval);
    EXPECT_TRUE(outcome.ok);
    EXPECT_EQ(outcome.reply, "approved");
  }
  EXPECT_EQ(runs, 1);
  EXPECT_THAT(registry.decisions("CB4", "BDR"), SizeIs(2));
  EXPECT_THAT(rows(path,
                   "SELECT requester, request, action, version, actor, time, ok, reply "
                   "FROM command"),
              ElementsAre("console-1|-1|approve|1|Ana|20|1|approved"));
  command.version = 2;
  const CommandOutcome other = registry.execute(command, 40, approval);
  EXPECT_FALSE(other.ok);
  EXPECT_THAT(other.reply, HasSubstr("was another command (approve)"));
  EXPECT_EQ(runs, 1);
}

TEST_F(OperatorDecisions, ARefusedCommandIsKeptToo) {
  const Command command = approval_of(1);
  const auto refusal = [] { return CommandOutcome{false, "not waiting"}; };
  registry.execute(command, 20, refusal);
  EXPECT_THAT(rows(path, "SELECT ok, reply FROM command"), ElementsAre("0|not waiting"));
}

TEST_F(OperatorDecisions, CommandsAreReadAsTheyWereGivenTheNewestFirst) {
  const Command first = approval_of(1), last = approval_of(0xffffffffffffffff);
  registry.execute(first, 20, [] { return CommandOutcome{true, "approved"}; });
  registry.execute(last, 30, [] { return CommandOutcome{false, "not waiting"}; });
  const auto both = registry.commands({20, 31}, 10);
  ASSERT_THAT(both, SizeIs(2));
  EXPECT_EQ(both[0].command, last);
  EXPECT_EQ(both[0].time, 30);
  EXPECT_FALSE(both[0].outcome.ok);
  EXPECT_EQ(both[1].command, first);
  EXPECT_EQ(both[1].outcome.reply, "approved");
  EXPECT_THAT(registry.commands({20, 31}, 1), SizeIs(1));
  EXPECT_THAT(registry.commands({21, 30}, 10), SizeIs(0));
}

TEST_F(OperatorDecisions, ACommandAndItsEffectAreKeptBothOrNeither) {
  version(10, wait);
  const Command command = approval_of(1);
  rows(path,
       "CREATE TRIGGER refuse BEFORE INSERT ON command "
       "BEGIN SELECT RAISE(ABORT, 'not today'); END");
  const auto approval = [&] {
    decide(1, approve, 20);
    return CommandOutcome{true, "approved"};
  };
  EXPECT_THAT(error_of([&] { registry.execute(command, 20, approval); }), HasSubstr("not today"));
  EXPECT_THAT(statuses(), ElementsAre("waiting"));
  rows(path, "DROP TRIGGER refuse");
  EXPECT_TRUE(registry.execute(command, 20, approval).ok);
  EXPECT_THAT(statuses(), ElementsAre("approved"));
}

}  // namespace
}  // namespace reident::storage::test::operator_decisions_test
