#include "storage/registry/registry.hpp"

#include <thread>

#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::registry_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST_F(RegistryTest, StartsEmpty) {
  EXPECT_THAT(registry.champions(), IsEmpty());
  EXPECT_THAT(registry.attempts(), IsEmpty());
  EXPECT_THAT(registry.decisions("CB4", "BDR"), IsEmpty());
  EXPECT_EQ(registry.champion("CB4", "BDR"), std::nullopt);
  EXPECT_EQ(registry.version("CB4", "BDR", 1), std::nullopt);
  EXPECT_EQ(registry.last_window_end("CB4", "BDR"), std::nullopt);
}

TEST_F(RegistryTest, GivesAnAttemptWithoutAModelBack) {
  const NewAttempt tried = attempt(5, {10, 20});
  const std::int64_t id = registry.record(tried);
  const std::vector<Attempt> attempts = registry.attempts();
  ASSERT_THAT(attempts, SizeIs(1));
  const Attempt& found = attempts[0];
  EXPECT_EQ(found.id, id);
  EXPECT_EQ(found.version, std::nullopt);
  EXPECT_EQ(found.spacecraft, tried.spacecraft);
  EXPECT_EQ(found.equipment, tried.equipment);
  EXPECT_EQ(found.window, tried.window);
  EXPECT_EQ(found.trigger, tried.trigger);
  EXPECT_EQ(found.time, tried.time);
  EXPECT_EQ(found.outcome, tried.outcome);
  EXPECT_EQ(found.reason, tried.reason);
  EXPECT_EQ(found.evidence_json, tried.evidence_json);
  EXPECT_EQ(found.configuration_digest, tried.configuration_digest);
  EXPECT_EQ(found.program_version, tried.program_version);
  EXPECT_THAT(registry.champions(), IsEmpty());
  ASSERT_TRUE(registry.attempt(id));
  EXPECT_EQ(registry.attempt(id)->evidence_json, tried.evidence_json);
  EXPECT_EQ(registry.attempt(id)->version, std::nullopt);
  EXPECT_FALSE(registry.attempt(id + 1));
}

TEST_F(RegistryTest, GivesAVersionBack) {
  registry.record(attempt(1));
  const std::int64_t number = registry.record(attempt(5, {10, 20}),
                                              {.model_json = R"({"A":[[0.5]]})",
                                               .digest = "abc",
                                               .provenance_json = R"({"rows":20})",
                                               .samples_digest = "def"},
                                              decision(DecisionKind::approve));
  EXPECT_EQ(number, 1);
  const std::optional<Version> found = registry.version("CB4", "BDR", 1);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->spacecraft, "CB4");
  EXPECT_EQ(found->equipment, "BDR");
  EXPECT_EQ(found->number, 1);
  EXPECT_EQ(found->attempt, registry.attempts().back().id);
  EXPECT_EQ(registry.attempts().back().version, 1);
  EXPECT_EQ(found->window, (TimeRange{10, 20}));
  EXPECT_EQ(found->created, 5);
  EXPECT_EQ(found->model_json, R"({"A":[[0.5]]})");
  EXPECT_EQ(found->digest, "abc");
  EXPECT_EQ(found->provenance_json, R"({"rows":20})");
  EXPECT_EQ(found->samples_digest, "def");
  EXPECT_EQ(found->status, "approved");
}

TEST_F(RegistryTest, CountsTheVersionsOfEachEquipmentFromOne) {
  EXPECT_EQ(version(1, DecisionKind::reject), 1);
  EXPECT_EQ(version(2, DecisionKind::approve, "BAT1"), 1);
  EXPECT_EQ(version(3, DecisionKind::approve), 2);
  NewAttempt other = attempt(4);
  other.spacecraft = "CB4A";
  EXPECT_EQ(registry.record(other, {}, decision(DecisionKind::approve)), 1);
  EXPECT_THAT(registry.champions(), SizeIs(3));
}

TEST_F(RegistryTest, TellsWhichVersionsOfAnOutcomeWait) {
  const auto wait = [this](const std::string& outcome) {
    NewAttempt tried = attempt(1);
    tried.outcome = outcome;
    return registry.record(tried, {"{}", "d"}, decision(DecisionKind::wait));
  };
  const auto waiting = [this](const char* outcome, std::int64_t after = 0) {
    return registry.waiting("CB4", "BDR", outcome, after);
  };
  EXPECT_THAT(waiting("challenger"), IsEmpty());
  for (const char* outcome : {"challenger", "waiting", "challenger", "challenger"}) wait(outcome);
  EXPECT_THAT(waiting("challenger"), ElementsAre(1, 3, 4));
  EXPECT_THAT(waiting("challenger", 3), ElementsAre(4)) << "behind the third decision";
  decide(3, DecisionKind::reject, 2);
  decide(1, DecisionKind::wait, 3);
  EXPECT_THAT(waiting("challenger"), ElementsAre(1, 4)) << "for another reason now";
  EXPECT_THAT(waiting("waiting"), ElementsAre(2));
  EXPECT_THAT(registry.waiting("CB4", "MEA", "challenger"), IsEmpty());
}

TEST_F(RegistryTest, LetsWhoJudgedAnewApproveAfterTheChampionChanged) {
  version(10, DecisionKind::approve);
  version(20, DecisionKind::wait);
  version(30, DecisionKind::approve);
  const DecisionState state = registry.decision_state("CB4", "BDR");
  const NewDecision better{DecisionKind::approve, "gate", "better", R"({"rows":9})"};
  EXPECT_TRUE(registry.decide_if(state, "CB4", "BDR", 2, better, 40));
  EXPECT_EQ(registry.version("CB4", "BDR", 2)->parent, 3);
  EXPECT_EQ(registry.decisions("CB4", "BDR", 2).back().evidence_json, R"({"rows":9})");
  EXPECT_EQ(champion_at(std::nullopt), 2);
  version(50, DecisionKind::wait);
  EXPECT_FALSE(registry.decide_if(state, "CB4", "BDR", 4, better, 60))
      << "decisions were made since";
  EXPECT_THAT(error_of([&] {
                registry.decide_if(registry.decision_state("CB4", "BDR"), "CB4", "BDR", 3, better,
                                   60);
              }),
              HasSubstr("is superseded"));
}

TEST_F(RegistryTest, ReturnsToTheChampionBeforeWhereTheOneThatRunsIsWithdrawnOnACondition) {
  version(10, DecisionKind::approve);
  version(20, DecisionKind::approve);
  const DecisionState state = registry.decision_state("CB4", "BDR");
  EXPECT_TRUE(
      registry.decide_if(state, "CB4", "BDR", 2, {DecisionKind::withdraw, "gate", "fails"}, 30));
  EXPECT_EQ(champion_at(std::nullopt), 1);
}

TEST_F(RegistryTest, DerivesTheStatusFromTheDecisions) {
  version(10, DecisionKind::approve);
  EXPECT_THAT(statuses(), ElementsAre("approved"));
  version(20, DecisionKind::reject);
  EXPECT_THAT(statuses(), ElementsAre("approved", "rejected"));
  version(30, DecisionKind::wait);
  EXPECT_THAT(statuses(), ElementsAre("approved", "rejected", "waiting"));
  decide(3, DecisionKind::approve, 35);
  EXPECT_THAT(statuses(), ElementsAre("superseded", "rejected", "approved"));
  decide(1, DecisionKind::roll_back, 40);
  EXPECT_THAT(statuses(), ElementsAre("approved", "rejected", "superseded"));
  version(50, DecisionKind::wait);
  decide(4, DecisionKind::reject, 55);
  EXPECT_THAT(statuses(), ElementsAre("approved", "rejected", "superseded", "rejected"));
  decide(3, DecisionKind::withdraw, 60);
  EXPECT_THAT(statuses(), ElementsAre("approved", "rejected", "withdrawn", "rejected"));
}

TEST_F(RegistryTest, KnowsTheChampionAtEveryTime) {
  version(10, DecisionKind::approve);
  version(20, DecisionKind::approve);
  version(30, DecisionKind::reject);
  decide(1, DecisionKind::roll_back, 40);
  const std::pair<Time, std::int64_t> table[] = {{9, 0},  {10, 1}, {19, 1}, {20, 2},
                                                 {30, 2}, {39, 2}, {40, 1}, {1000, 1}};
  for (const auto& [time, champion] : table) EXPECT_EQ(champion_at(time), champion) << time;
  EXPECT_EQ(champion_at(std::nullopt), 1);
  ASSERT_THAT(registry.champions(), SizeIs(1));
  EXPECT_EQ(registry.champions()[0].number, 1);
}

TEST_F(RegistryTest, FollowsTheOrderOfDecisionsWhenTheClockWasSetBack) {
  version(100, DecisionKind::approve);
  version(50, DecisionKind::approve);
  EXPECT_EQ(champion_at(std::nullopt), 2);
  EXPECT_EQ(champion_at(100), 2);
  EXPECT_EQ(champion_at(60), 2);
  EXPECT_EQ(champion_at(49), 0);
}

TEST_F(RegistryTest, GivesDecisionsInTheirOrder) {
  version(10, DecisionKind::wait);
  version(20, DecisionKind::wait);
  decide(1, DecisionKind::approve, 30);
  const std::vector<Decision> all = registry.decisions("CB4", "BDR");
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_LT(all[0].id, all[1].id);
  EXPECT_EQ(all[2].version, 1);
  EXPECT_EQ(all[2].kind, DecisionKind::approve);
  EXPECT_EQ(all[2].actor, "Ana");
  EXPECT_EQ(all[2].reason, "because");
  EXPECT_EQ(all[2].time, 30);
  EXPECT_THAT(registry.decisions("CB4", "BDR", 1), SizeIs(2));
  EXPECT_THAT(registry.decisions("CB4", "BDR", 9), IsEmpty());
  EXPECT_THAT(registry.decisions("CB4", "BAT1"), IsEmpty());
}

TEST_F(RegistryTest, RefusesADecisionAboutAVersionThatIsNotThere) {
  EXPECT_THAT(error_of([&] { decide(3, DecisionKind::approve, 1); }),
              AllOf(StartsWith("failed: "), HasSubstr("BDR of CB4 has no version 3")));
  EXPECT_THAT(registry.decisions("CB4", "BDR"), IsEmpty());
}

TEST_F(RegistryTest, FiltersTheHistory) {
  registry.record(attempt(1, {0, 100}));            // 1
  version(2, DecisionKind::approve);                // 2, window 0 to 100
  registry.record(attempt(3, {100, 200}));          // 3
  registry.record(attempt(4, {100, 200}, "BAT1"));  // 4
  version(5, DecisionKind::reject, "BAT1");         // 5, window 0 to 100
  NewAttempt other = attempt(6, {50, 150});
  other.spacecraft = "CB4A";
  registry.record(other);  // 6

  const auto filter = [](const std::string& spacecraft, const std::string& equipment,
                         std::optional<TimeRange> window, bool versions_only,
                         std::optional<std::size_t> last) {
    return HistoryFilter{spacecraft, equipment, window, versions_only, last};
  };
  const struct {
    HistoryFilter filter;
    std::vector<std::int64_t> ids;
  } table[] = {
      {filter("", "", {}, false, {}), {1, 2, 3, 4, 5, 6}},
      {filter("CB4", "", {}, false, {}), {1, 2, 3, 4, 5}},
      {filter("CB4", "BAT1", {}, false, {}), {4, 5}},
      {filter("", "BDR", {}, false, {}), {1, 2, 3, 6}},
      {filter("CB5", "", {}, false, {}), {}},
      {filter("", "", {}, true, {}), {2, 5}},
      {filter("", "", {}, false, 2), {5, 6}},
      {filter("", "", {}, true, 1), {5}},
      {filter("", "", {}, false, 0), {}},
      {filter("", "", TimeRange{0, 50}, false, {}), {1, 2, 5}},
      {filter("", "", TimeRange{100, 101}, false, {}), {3, 4, 6}},
      {filter("", "", TimeRange{99, 101}, false, {}), {1, 2, 3, 4, 5, 6}},
      {filter("", "", TimeRange{200, 300}, false, {}), {}},
      {filter("CB4", "BDR", TimeRange{0, 300}, false, 1), {3}},
  };
  for (std::size_t i = 0; i < std::size(table); ++i) {
    std::vector<std::int64_t> ids;
    for (const Attempt& found : registry.attempts(table[i].filter)) ids.push_back(found.id);
    EXPECT_EQ(ids, table[i].ids) << "row " << i;
  }
}

TEST_F(RegistryTest, KnowsTheEndOfTheLatestWindowTried) {
  registry.record(attempt(1, {100, 200}));
  version(2, DecisionKind::approve);
  registry.record(attempt(3, {300, 400}, "BAT1"));
  EXPECT_EQ(registry.last_window_end("CB4", "BDR"), 200) << "the latest window, not the last row";
  EXPECT_EQ(registry.last_window_end("CB4", "BAT1"), 400);
}

TEST_F(RegistryTest, NothingRecordedCanBeChangedOrRemoved) {
  version(10, DecisionKind::approve);
  registry.put_on_hold("CB4", "BDR", {"Ana", "because", 11});
  registry.execute({"console", 1, "approve", "CB4", "BDR", 1, "Ana", "because"}, 12, [] {
    return CommandOutcome{true, "done"};
  });
  const char* table[] = {
      "UPDATE attempt SET outcome = 'approved'",
      "DELETE FROM attempt",
      "INSERT OR REPLACE INTO attempt SELECT id, spacecraft, equipment, window_begin, window_end, "
      "cause, time, 'x', reason, evidence_json, configuration_digest, program_version FROM attempt",
      "UPDATE version SET model_json = '{}'",
      "DELETE FROM version",
      "INSERT OR REPLACE INTO version SELECT spacecraft, equipment, number, attempt, 'x', 'x', "
      "'x', 'x' FROM version",
      "UPDATE decision SET kind = 'reject'",
      "DELETE FROM decision",
      "INSERT OR REPLACE INTO decision SELECT id, spacecraft, equipment, version, 'reject', actor, "
      "reason, time, evidence_json FROM decision",
      "UPDATE hold SET kind = 'release'",
      "DELETE FROM hold",
      "INSERT OR REPLACE INTO hold SELECT id, spacecraft, equipment, 'release', actor, reason, "
      "time FROM hold",
      "UPDATE command SET ok = 0",
      "DELETE FROM command",
      "INSERT OR REPLACE INTO command SELECT id + 1, requester, request, action, spacecraft, "
      "equipment, version, actor, reason, time, 0, reply FROM command",
  };
  for (const char* statement : table)
    EXPECT_THAT(rows(path, statement), ElementsAre(HasSubstr(" are never "))) << statement;
  EXPECT_EQ(registry.version("CB4", "BDR", 1)->status, "approved");
  EXPECT_EQ(registry.version("CB4", "BDR", 1)->digest, "d10");
  EXPECT_TRUE(registry.hold("CB4", "BDR"));
}

TEST_F(RegistryTest, AVersionIsRecordedWholeOrNotAtAll) {
  rows(path,
       "CREATE TRIGGER refuse BEFORE INSERT ON decision "
       "BEGIN SELECT RAISE(ABORT, 'not today'); END");
  EXPECT_THAT(error_of([&] { version(10, DecisionKind::approve); }), HasSubstr("not today"));
  EXPECT_THAT(registry.attempts(), IsEmpty());
  EXPECT_EQ(registry.version("CB4", "BDR", 1), std::nullopt);
  rows(path, "DROP TRIGGER refuse");
  EXPECT_EQ(version(20, DecisionKind::approve), 1);
}

TEST_F(RegistryTest, OutlivesItsProcess) {
  version(10, DecisionKind::approve);
  database = Database(folder / "other.db", Mode::read_write);
  database = Database(path, Mode::read_write);
  EXPECT_EQ(champion_at(std::nullopt), 1);
  EXPECT_EQ(version(20, DecisionKind::approve), 2);
}

TEST_F(RegistryTest, ReadersFollowWhileVersionsAreRecorded) {
  version(1, DecisionKind::approve);
  constexpr std::int64_t versions = 30;
  std::vector<std::string> complaints[2];
  const auto follow = [&](std::vector<std::string>& complaints_of_one) {
    Database own(path, Mode::read_only);
    const Registry view(own);
    for (std::int64_t last = 0; last < versions;) {
      const std::vector<Version> champions = view.champions();
      if (champions.size() != 1) complaints_of_one.emplace_back("not one champion");
      if (champions[0].number < last) complaints_of_one.emplace_back("back in time");
      if (champions[0].status != "approved") complaints_of_one.emplace_back("no champion's status");
      last = champions[0].number;
    }
  };
  std::thread first(follow, std::ref(complaints[0])), second(follow, std::ref(complaints[1]));
  for (std::int64_t number = 2; number <= versions; ++number)
    version(number, DecisionKind::approve);
  first.join();
  second.join();
  EXPECT_THAT(complaints[0], IsEmpty());
  EXPECT_THAT(complaints[1], IsEmpty());
}

}  // namespace
}  // namespace reident::storage::test::registry_test
