// What a plain sqlite3 user sees: views with names and texts, and answers that need no full scan.
#include <limits>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::sql_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

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

TEST_F(SqlTest, UnitThatIsNotKnownIsNull) {
  append({frame(1, 10, {{1, Quality::good, 28}, {7, Quality::good, 3}})});
  rows(path, "UPDATE parameter SET unit = ''");
  EXPECT_THAT(ask("SELECT parameter, unit FROM telemetry_series ORDER BY parameter"),
              ElementsAre("7|NULL", "V_BUS|NULL"));
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
}  // namespace reident::storage::test::sql_test
