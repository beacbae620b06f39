// What a plain sqlite3 user sees: views with names and texts, and answers that need no full scan.
#include <limits>

#include "fixture.hpp"

namespace reident::storage::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class SqlTest : public ArchiveTest {
 protected:
  Registry registry{database};

  void SetUp() override {
    ParameterDescriptor bus;
    bus.spacecraft = "CB4";
    bus.id = 1;
    bus.name = "V_BUS";
    bus.unit = "V";
    archive.describe(std::span(&bus, 1));
  }
  std::int64_t version(Time time, DecisionKind kind) {
    return registry.record(attempt(time), {.model_json = "{}", .digest = std::to_string(time)},
                           {.kind = kind, .actor = "gate", .reason = "better"});
  }
  static NewAttempt attempt(Time time) {
    NewAttempt attempt;
    attempt.spacecraft = "CB4";
    attempt.equipment = "BDR";
    attempt.window = {0, 100};
    attempt.trigger = "slide";
    attempt.time = time;
    attempt.outcome = "approved";
    return attempt;
  }
  std::vector<std::string> ask(const std::string& sql) const { return rows(path, sql); }
};

TEST_F(SqlTest, TelemetryHasARowForEachSample) {
  TelemetryFrame simulated = frame(1, -1, {{1, Quality::suspect, 27}});
  simulated.origin = Origin::simulated;
  simulated.source = "simcbers";
  append({frame(1, 1'500'000'000, {{1, Quality::good, 28.5}, {2, Quality::out_of_limits, 0}}),
          frame(2, 1'511'222'333'444'555'666,
                {{1, Quality::good, std::numeric_limits<double>::quiet_NaN()}}),
          simulated});
  EXPECT_THAT(
      ask("SELECT * FROM telemetry ORDER BY origin, parameter, time"),
      ElementsAre(
          "CB4|2|real|station|1500000000|1970-01-01T00:00:01.500000000Z|0.0|out of limits",
          "CB4|V_BUS|real|station|1500000000|1970-01-01T00:00:01.500000000Z|28.5|good",
          "CB4|V_BUS|real|station|1511222333444555666|2017-11-20T23:58:53.444555666Z|NULL|invalid",
          "CB4|V_BUS|simulated|simcbers|-1|1969-12-31T23:59:59.999999999Z|27.0|suspect"));
}

TEST_F(SqlTest, AParameterWithoutADescriptorIsNamedByItsId) {
  append({frame(1, 10, {{7, Quality::good, 5}})});
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE parameter = '7'"), ElementsAre("5.0"));
}

TEST_F(SqlTest, TelemetryShowsTheExtremesOfTime) {
  append({frame(1, std::numeric_limits<Time>::min(), {{1, Quality::good, 1}}),
          frame(2, std::numeric_limits<Time>::max(), {{1, Quality::good, 2}})});
  EXPECT_THAT(ask("SELECT utc FROM telemetry ORDER BY time"),
              ElementsAre("1677-09-21T00:12:43.145224192Z", "2262-04-11T23:47:16.854775807Z"));
}

TEST_F(SqlTest, AQuestionAboutOneParameterSearchesItsSamplesAlone) {
  append({frame(1, 10, {{1, Quality::good, 28}, {2, Quality::good, 5}})});
  const std::string plan = ::testing::PrintToString(
      ask("EXPLAIN QUERY PLAN SELECT avg(value) FROM telemetry "
          "WHERE spacecraft = 'CB4' AND parameter = 'V_BUS' AND time >= 0 AND time < 100"));
  EXPECT_THAT(plan, HasSubstr("SEARCH sample USING PRIMARY KEY (series=? AND time>? AND time<?)"));
  EXPECT_THAT(plan, Not(HasSubstr("SCAN sample")));
}

TEST_F(SqlTest, SeriesSourcesAndGapsHaveViews) {
  append({frame(1, 10, {{1, Quality::good, 28}}), frame(4, 20, {{1, Quality::good, 29}}),
          frame(std::numeric_limits<std::uint64_t>::max(), 30, {})});
  EXPECT_THAT(ask("SELECT * FROM telemetry_series"), ElementsAre("CB4|V_BUS|real|V|2|10|20"));
  EXPECT_THAT(ask("SELECT spacecraft, source, origin, frames, samples, missing, last_sequence "
                  "FROM telemetry_source"),
              ElementsAre("CB4|station|real|3|2|18446744073709551612|18446744073709551615"));
  EXPECT_THAT(ask("SELECT * FROM telemetry_gap"),
              ElementsAre("CB4|station|real|0|2|3|10|20",
                          "CB4|station|real|0|5|18446744073709551614|20|30"));
}

TEST_F(SqlTest, VersionsChampionAndHistoryHaveViews) {
  version(7, DecisionKind::approve);
  version(9, DecisionKind::wait);
  NewAttempt failed = attempt(11);
  failed.outcome = "too_few_samples";
  registry.record(failed);
  EXPECT_THAT(ask("SELECT equipment, version, since, digest FROM champion"),
              ElementsAre("BDR|1|7|7"));
  EXPECT_THAT(ask("SELECT version, status, created FROM model_version ORDER BY version"),
              ElementsAre("1|approved|7", "2|waiting|9"));
  EXPECT_THAT(
      ask("SELECT attempt, equipment, cause, outcome, version, last_decision FROM history "
          "ORDER BY attempt"),
      ElementsAre("1|BDR|slide|approved|1|approve by gate", "2|BDR|slide|approved|2|wait by gate",
                  "3|BDR|slide|too_few_samples|NULL|NULL"));
}

TEST_F(SqlTest, ChampionIsSinceTheDecisionThatMadeIt) {
  version(7, DecisionKind::approve);
  version(8, DecisionKind::approve);
  registry.decide("CB4", "BDR", 1, {.kind = DecisionKind::roll_back, .actor = "Ana", .reason = ""},
                  50);
  EXPECT_THAT(ask("SELECT version, since FROM champion"), ElementsAre("1|50"));
}

TEST_F(SqlTest, LateTelemetryHasAView) {
  archive.seal("CB4", 1000);
  append({frame(1, 10, {{1, Quality::good, 28}})});
  EXPECT_THAT(ask("SELECT * FROM telemetry_late"), ElementsAre("CB4|V_BUS|real|10|11"));
  archive.forget_late(archive.late_ranges("CB4"));
  EXPECT_THAT(ask("SELECT * FROM telemetry_late"), IsEmpty());
}

}  // namespace
}  // namespace reident::storage::testing
