#include "service/operations/league_keeper.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"
#include "tests/service/reason_codes.hpp"

namespace reident::test::league_keeper_test {
namespace {

using storage::DecisionKind;
using testing::IsEmpty;
using testing::SizeIs;

/// A plant that is identified every five minutes, and its league.
class Keeper : public DaemonTest {
 protected:
  Keeper() { archive.describe(descriptors()); }

  /// Records the window that ends at `end`, and advances the league to there.
  void window(storage::Time end) {
    WindowCache nothing = window_cache_of("SAT", equipment);
    const RefreshResult result =
        refresh(archive, registry, {"SAT", equipment, {end - equipment.window, end}, "slide", ""},
                nothing, {}, [] { return false; });
    if (result.candidate)
      registry.record(result.attempt, result.version, *result.decision);
    else
      registry.record(result.attempt);
    advance(*keeper, end);
  }
  void windows(storage::Time from, storage::Time to) {
    for (storage::Time end = from; end <= to; end += equipment.slide) window(end);
  }
  /// The windows of 50 minutes in another registry; each in a service of its own, if `restarting`.
  void windows(storage::Registry& records, bool restarting, const LeagueWriter& writer) {
    std::optional<LeagueKeeper> league(std::in_place, "SAT", equipment);
    for (storage::Time end = day + 10 * minute; end <= day + 50 * minute; end += 5 * minute) {
      WindowCache nothing = window_cache_of("SAT", equipment);
      const RefreshResult result =
          refresh(archive, records, {"SAT", equipment, {end - 10 * minute, end}, "slide", ""},
                  nothing, {}, [] { return false; });
      if (result.candidate) records.record(result.attempt, result.version, *result.decision);
      if (restarting) league.emplace("SAT", equipment);
      league->advance(archive, records, end, writer);
    }
  }
  std::optional<storage::TimeRange> advance(LeagueKeeper& league, storage::Time reached) {
    LeagueWriter writer;
    writer.scores = [this](const auto& block, const auto& scores) {
      registry.record_scores("SAT", "PLANT", block, scores);
    };
    writer.decide = [this](const storage::DecisionState& state, const LeagueDecision& found) {
      return registry.decide_if(state, "SAT", "PLANT", found.version.number, found.decision, day)
          .has_value();
    };
    writer.failure = [this](const std::optional<Reason>& reason) { failures.push_back(reason); };
    writer.change = [this](const storage::FoundChange& found) { changes.push_back(found); };
    return league.advance(archive, registry, reached, writer);
  }
  void restart() { keeper.emplace("SAT", equipment); }
  std::int64_t champion() const {
    const auto found = registry.champion("SAT", "PLANT");
    return found ? found->number : 0;
  }
  std::vector<std::string> codes(DecisionKind kind) const {
    std::vector<std::string> found;
    for (const storage::Decision& decision : registry.decisions("SAT", "PLANT"))
      if (decision.kind == kind && !decision.evidence_json.empty())
        found.push_back(code_in(decision.evidence_json));
    return found;
  }
  std::vector<storage::BlockScore> scores(std::int64_t version) const {
    return registry.scores("SAT", "PLANT", version, INT64_MIN);
  }

  EquipmentConfig equipment = plant();
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
  std::optional<LeagueKeeper> keeper{std::in_place, "SAT", equipment};
  std::vector<std::optional<Reason>> failures;
  std::vector<storage::FoundChange> changes;
};

TEST_F(Keeper, ApprovesTheFirstVersionOnItsValidationPart) {
  archive.append(telemetry(day, 601));
  window(day + 10 * minute);
  EXPECT_EQ(champion(), 1);
  EXPECT_THAT(codes(DecisionKind::approve), testing::ElementsAre("first_version"));
  EXPECT_THAT(scores(1), SizeIs(28 + 12)) << "a first version runs on all blocks of its window";
}

TEST_F(Keeper, FollowsAPlantThatHasChanged) {
  archive.append(telemetry(day, 1200));
  archive.append(telemetry(day + 20 * minute, 1801, 2));
  windows(day + 10 * minute, day + 50 * minute);
  EXPECT_GT(champion(), 1);
  EXPECT_THAT(codes(DecisionKind::approve), testing::Contains("better"));
  const auto found = registry.version("SAT", "PLANT", champion());
  EXPECT_GT(found->window.end, day + 20 * minute);
}

TEST_F(Keeper, GivesTheSameScoresAndDecisionsWhereverItWasRestarted) {
  archive.append(telemetry(day, 1200));
  archive.append(telemetry(day + 20 * minute, 1801, 2));
  const auto run = [&](bool restarting, const char* name) {
    storage::Database other(path().string() + name, storage::Database::Mode::read_write);
    storage::Registry records(other);
    std::string all;
    LeagueWriter writer;
    writer.scores = [&](const auto& block, const auto& scores) {
      records.record_scores("SAT", "PLANT", block, scores);
    };
    writer.decide = [&](const storage::DecisionState& state, const LeagueDecision& found) {
      all += found.decision.evidence_json + "\n";
      return records.decide_if(state, "SAT", "PLANT", found.version.number, found.decision, day)
          .has_value();
    };
    windows(records, restarting, writer);
    return all;
  };
  const std::string once = run(false, "-once");
  EXPECT_THAT(once, testing::HasSubstr("better"));
  EXPECT_EQ(run(true, "-again"), once);
}

TEST_F(Keeper, RunsANewVersionOnARegimeFromBeforeItsWindowToTheSameBits) {
  archive.append(telemetry(day, 1500));
  archive.append(operation(day + 25 * minute, 1501, {.u = 0.2, .v = 0.2, .since = day}));
  const auto run = [&](bool restarting) {
    storage::Database other(path().string() + (restarting ? "-again" : "-once"),
                            storage::Database::Mode::read_write);
    storage::Registry records(other);
    std::vector<storage::BlockScore> before;
    LeagueWriter writer;
    writer.scores = [&](const auto& block, const auto& scores) {
      records.record_scores("SAT", "PLANT", block, scores);
      for (const storage::BlockScore& score : scores)
        if (records.version("SAT", "PLANT", score.version)->window.begin > score.begin)
          before.push_back(score);
    };
    writer.decide = [&](const storage::DecisionState& state, const LeagueDecision& found) {
      return records.decide_if(state, "SAT", "PLANT", found.version.number, found.decision, day)
          .has_value();
    };
    windows(records, restarting, writer);
    return before;
  };
  const auto once = run(false), again = run(true);
  ASSERT_FALSE(once.empty());
  ASSERT_EQ(again.size(), once.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_LT(once[i].begin, day + 25 * minute + 3 * minute / 4);
    EXPECT_EQ(again[i].begin, once[i].begin);
    EXPECT_EQ(again[i].square, once[i].square);
    EXPECT_EQ(once[i].rows, 15);
  }
}

TEST_F(Keeper, LeavesTheDecisionToAnOperatorWhereThePolicySaysSo) {
  equipment.approval = ApprovalPolicy::by_hand;
  restart();
  archive.append(telemetry(day, 1201));
  windows(day + 10 * minute, day + 20 * minute);
  EXPECT_EQ(champion(), 0);
  EXPECT_THAT(codes(DecisionKind::wait), testing::Contains("waits_for_operator"));
  const std::size_t said = codes(DecisionKind::wait).size();
  advance(*keeper, day + 20 * minute);
  EXPECT_THAT(codes(DecisionKind::wait), SizeIs(said)) << "once";
}

TEST_F(Keeper, ReplacesNoChampionThatIsHeld) {
  archive.append(telemetry(day, 1200));
  archive.append(telemetry(day + 20 * minute, 1801, 2));
  window(day + 10 * minute);
  registry.put_on_hold("SAT", "PLANT", {"ana", "rehearsal", 1});
  windows(day + 15 * minute, day + 50 * minute);
  EXPECT_EQ(champion(), 1);
  EXPECT_THAT(codes(DecisionKind::wait), testing::Contains("held"));
  registry.release("SAT", "PLANT", {"ana", "done", 2});
  restart();
  advance(*keeper, day + 50 * minute);
  EXPECT_GT(champion(), 1);
}

TEST_F(Keeper, PassesOverWhatAnOperatorKnewWhenRollingBack) {
  archive.append(telemetry(day, 1200));
  archive.append(telemetry(day + 20 * minute, 1801, 2));
  windows(day + 10 * minute, day + 50 * minute);
  ASSERT_GT(champion(), 1);
  registry.decide("SAT", "PLANT", 1, {DecisionKind::roll_back, "ana", "training"}, day);
  advance(*keeper, day + 50 * minute);
  EXPECT_EQ(champion(), 1);
}

TEST_F(Keeper, ScoresABlockWithoutTelemetryOrWithDamagedOneAsNothing) {
  archive.append(telemetry(day, 601));
  window(day + 10 * minute);
  archive.append(telemetry(day + 15 * minute, 601));
  archive.compact();
  restart();
  advance(*keeper, day + 20 * minute);
  auto blocks = registry.blocks("SAT", "PLANT", day + 11 * minute);
  ASSERT_FALSE(blocks.empty());
  EXPECT_EQ(blocks.front().rows, 0) << "a gap";
  EXPECT_GT(blocks.back().rows, 0) << "telemetry is back";
  damage_chunks(2);
  restart();
  advance(*keeper, day + 24 * minute);
  blocks = registry.blocks("SAT", "PLANT", day + 21 * minute);
  ASSERT_FALSE(blocks.empty());
  EXPECT_EQ(blocks.front().rows, 0) << "damaged";
  EXPECT_EQ(champion(), 1);
}

TEST_F(Keeper, LeavesOutAMemberThatCannotBeDecoded) {
  archive.append(telemetry(day, 1201));
  window(day + 10 * minute);
  WindowCache nothing = window_cache_of("SAT", equipment);
  const RefreshResult result = refresh(
      archive, registry, {"SAT", equipment, {day + 5 * minute, day + 15 * minute}, "slide", ""},
      nothing, {}, [] { return false; });
  storage::NewAttempt attempt = result.attempt;
  attempt.outcome = "challenger";
  registry.record(attempt, {"{ not a model", "0"}, {DecisionKind::wait, "gate", "enters"});
  advance(*keeper, day + 20 * minute);
  EXPECT_THAT(scores(2), IsEmpty());
  EXPECT_THAT(scores(1), SizeIs(28 + 12 + 40));
}

TEST_F(Keeper, DecidesNothingOnADamagedRecord) {
  archive.append(telemetry(day, 1201));
  window(day + 10 * minute);
  ASSERT_EQ(champion(), 1);
  for (const char* lost :
       {"error_square = x''", "error_mean = x'', error_square = x'', noise_square = x''",
        "error_mean = zeroblob(8), error_square = zeroblob(8), noise_square = zeroblob(8), "
        "state = zeroblob(800)"}) {
    SCOPED_TRACE(lost);
    run_sql("DROP TRIGGER IF EXISTS score_update; UPDATE score SET " + std::string(lost) +
            " WHERE begin_time = (SELECT max(begin_time) FROM score)");
    restart();
    EXPECT_THROW(advance(*keeper, day + 20 * minute), storage::Error);
    EXPECT_THAT(registry.blocks("SAT", "PLANT", day + 10 * minute), IsEmpty());
  }
}

TEST_F(Keeper, LeavesOutMembersThatAskForOtherTelemetryThanTheConfiguration) {
  archive.append(telemetry(day, 1201));
  window(day + 10 * minute);
  ASSERT_EQ(champion(), 1);
  equipment.inputs = {"u"};
  restart();
  const std::size_t before = scores(1).size();
  advance(*keeper, day + 20 * minute);
  EXPECT_THAT(scores(1), SizeIs(before));
  EXPECT_EQ(champion(), 1);
}

TEST_F(Keeper, ChangesNoScoreWhenTelemetryComesLateOrTheClockGoesBack) {
  archive.append(telemetry(day, 601));
  window(day + 10 * minute);
  advance(*keeper, day + 14 * minute);  // a gap so far
  const auto before = registry.blocks("SAT", "PLANT", INT64_MIN);
  archive.append(telemetry(day + 10 * minute + second, 240));
  keeper->forget({day + 10 * minute, day + 14 * minute});
  advance(*keeper, day + 12 * minute);
  advance(*keeper, day + 14 * minute);
  const auto after = registry.blocks("SAT", "PLANT", INT64_MIN);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].rows, before[i].rows) << i;
}

TEST_F(Keeper, DecidesNothingOnAnOldState) {
  archive.append(telemetry(day, 601));
  WindowCache nothing = window_cache_of("SAT", equipment);
  const RefreshResult result =
      refresh(archive, registry, {"SAT", equipment, {day, day + 10 * minute}, "slide", ""}, nothing,
              {}, [] { return false; });
  registry.record(result.attempt, result.version, *result.decision);
  LeagueWriter writer;
  writer.scores = [this](const auto& block, const auto& scores) {
    registry.record_scores("SAT", "PLANT", block, scores);
  };
  writer.decide = [this](const storage::DecisionState& state, const LeagueDecision& found) {
    if (!registry.hold("SAT", "PLANT")) registry.put_on_hold("SAT", "PLANT", {"ana", "between", 1});
    return registry.decide_if(state, "SAT", "PLANT", found.version.number, found.decision, day)
        .has_value();
  };
  keeper->advance(archive, registry, day + 10 * minute, writer);
  EXPECT_EQ(champion(), 0) << "an operator was quicker";
}

TEST_F(Keeper, FindsTheChangeOfThePlant) {
  archive.append(telemetry(day, 1800));
  archive.append(telemetry(day + 30 * minute, 601, 3));
  window(day + 10 * minute);
  std::optional<storage::TimeRange> change;
  for (storage::Time at = day + 11 * minute; at <= day + 40 * minute && !change; at += minute)
    change = advance(*keeper, at);
  ASSERT_TRUE(change);
  EXPECT_GE(change->begin, day + 29 * minute);
  EXPECT_LE(change->end, day + 36 * minute);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].champion, champion());
  EXPECT_GE(changes[0].since, day + 29 * minute);
  EXPECT_GT(changes[0].found, changes[0].since);
}

TEST_F(Keeper, SaysThatTheChampionFailsAndWithdrawsItWhereConfigured) {
  equipment.on_failure = FailurePolicy::withdraw;
  restart();
  archive.append(telemetry(day, 1200));
  archive.append(telemetry(day + 20 * minute, 1801, -3));
  window(day + 10 * minute);
  for (storage::Time at = day + 11 * minute; at <= day + 45 * minute; at += minute)
    advance(*keeper, at);
  ASSERT_THAT(failures, SizeIs(3));
  EXPECT_FALSE(failures[0]) << "at the first look none does";
  ASSERT_TRUE(failures[1]);
  EXPECT_EQ(failures[1]->code, ReasonCode::champion_failed);
  EXPECT_FALSE(failures[2]) << "without a champion none fails";
  EXPECT_EQ(champion(), 0);
  EXPECT_EQ(registry.version("SAT", "PLANT", 1)->status, "withdrawn");
}

}  // namespace
}  // namespace reident::test::league_keeper_test
