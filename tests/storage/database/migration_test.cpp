// A file that a program of an older schema version made becomes one of this version, with all that
// is in it.
#include <cmath>

#include "storage/database/schema.hpp"
#include "tests/storage/database/schema_1.hpp"
#include "tests/storage/database/schema_2.hpp"
#include "tests/storage/database/schema_3.hpp"
#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::migration_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

// Two versions of BDR with a rollback to the first, a waiting one of MEA, an attempt without a
// model, a sample.
constexpr const char* contents = R"sql(
PRAGMA journal_mode = WAL;
INSERT INTO series VALUES (1, 'CB4', 0, 7, 1, 10, 10);
INSERT INTO sample VALUES (1, 10, 28.5, 0, 1);
INSERT INTO attempt VALUES
  (1, 'CB4', 'BDR', 0, 100, 'slide', 110, 'approved', 'good', '{}', 'c', '0.1'),
  (2, 'CB4', 'BDR', 50, 150, 'slide', 160, 'approved', 'better', '{}', 'c', '0.1'),
  (3, 'CB4', 'BDR', 100, 200, 'slide', 210, 'low_coverage', 'gaps', '{}', 'c', '0.1'),
  (4, 'CB4', 'MEA', 100, 200, 'slide', 220, 'waiting', 'good', '{}', 'c', '0.1');
INSERT INTO version VALUES
  ('CB4', 'BDR', 1, 1, '{"a":1}', 'd1'), ('CB4', 'BDR', 2, 2, '{"a":2}', 'd2'),
  ('CB4', 'MEA', 1, 4, '{"a":3}', 'd3');
INSERT INTO decision VALUES
  (1, 'CB4', 'BDR', 1, 'approve', 'gate', 'good', 110),
  (2, 'CB4', 'BDR', 2, 'approve', 'gate', 'better', 160),
  (4, 'CB4', 'BDR', 1, 'roll_back', 'Ana', 'odd in eclipse', 170),
  (5, 'CB4', 'MEA', 1, 'wait', 'gate', 'good', 220);
)sql";

class Migration : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder / "old.db";
  void SetUp() override {
    rows(path, schema_1);
    rows(path, contents);
  }
};

TEST_F(Migration, KeepsEveryRowAndItsMeaning) {
  const char* tables[] = {"SELECT * FROM attempt",
                          "SELECT id, spacecraft, equipment, version, kind, actor, reason, time "
                          "FROM decision"};
  std::vector<std::vector<std::string>> before;
  for (const char* table : tables) before.push_back(rows(path, table));
  Database database(path, Mode::read_write);
  EXPECT_THAT(rows(path, "SELECT id, spacecraft, parameter, samples FROM series"),
              ElementsAre("1|CB4|7|1"));
  EXPECT_THAT(Archive(database).read("CB4", Origin::real, 7, {0, 100}).value, ElementsAre(28.5));
  for (std::size_t i = 0; i < std::size(tables); ++i)
    EXPECT_THAT(rows(path, tables[i]), ElementsAreArray(before[i])) << tables[i];
  EXPECT_THAT(rows(path,
                   "SELECT equipment, version, status, parent, digest, model_json, "
                   "samples_digest, provenance_json FROM model_version"),
              ElementsAre("BDR|1|approved|NULL|d1|{\"a\":1}||", "BDR|2|superseded|1|d2|{\"a\":2}||",
                          "MEA|1|waiting|NULL|d3|{\"a\":3}||"));
  EXPECT_THAT(rows(path, "PRAGMA user_version; PRAGMA integrity_check; PRAGMA foreign_key_check"),
              ElementsAre(std::to_string(schema::version), "ok"));
}

TEST_F(Migration, GoesOnWhereTheOldProgramStopped) {
  Database database(path, Mode::read_write);
  Registry registry(database);
  EXPECT_EQ(registry.champion("CB4", "BDR", 165)->number, 2);
  EXPECT_EQ(registry.champion_decision("CB4", "BDR")->actor, "Ana");
  EXPECT_EQ(registry.decide("CB4", "BDR", 2, {DecisionKind::withdraw, "Ana", "bad"}, 230), 6);
  EXPECT_EQ(registry.decide("CB4", "MEA", 1, {DecisionKind::approve, "Ana", "fine"}, 240), 7);
  EXPECT_EQ(registry.champion("CB4", "MEA")->number, 1);
  registry.put_on_hold("CB4", "MEA", {"Ana", "training", 250});
  EXPECT_THAT(rows(path, "DELETE FROM decision"), ElementsAre(HasSubstr(" are never ")));
  EXPECT_THAT(rows(path, "DELETE FROM version"), ElementsAre(HasSubstr(" are never ")));
}

TEST_F(Migration, GivesTheSameSchemaAsANewFile) {
  { const Database migrated(path, Mode::read_write); }
  { const Database made(folder / "new.db", Mode::read_write); }
  // A column that was added stands behind the others, in words of its own.
  const char* same =
      "SELECT type, name, sql FROM sqlite_master WHERE name NOT IN ('series', 'version') "
      "ORDER BY type, name";
  EXPECT_THAT(rows(path, same), ElementsAreArray(rows(folder / "new.db", same)));
  for (const std::string table : {"series", "version"}) {
    const std::string columns =
        "SELECT name, type, \"notnull\", dflt_value, pk FROM pragma_table_info('" + table +
        "') ORDER BY name";
    EXPECT_THAT(rows(path, columns), ElementsAreArray(rows(folder / "new.db", columns)));
  }
}

TEST_F(Migration, IsWholeOrNotAtAll) {
  rows(path, "CREATE TABLE command (theirs)");  // makes the last tables impossible
  const auto opening = [&] { const Database database(path, Mode::read_write); };
  EXPECT_THAT(error_of(opening), HasSubstr("command already exists"));
  EXPECT_THAT(rows(path,
                   "PRAGMA user_version; SELECT count(*) FROM decision; "
                   "SELECT version FROM champion"),
              ElementsAre("1", "4", "1"));
  rows(path, "DROP TABLE command");
  EXPECT_EQ(error_of(opening), "no error");
  EXPECT_THAT(rows(path, "SELECT count(*) FROM decision"), ElementsAre("4"));
}

TEST_F(Migration, IsLeftToAWriterAndAReaderSaysSo) {
  const auto reading = [&] { const Database database(path, Mode::read_only); };
  EXPECT_THAT(error_of(reading), AllOf(StartsWith("older_schema: "), HasSubstr("schema version 1"),
                                       HasSubstr("start this reidentd on it once")));
  EXPECT_THAT(rows(path, "PRAGMA user_version"), ElementsAre("1"));
  { const Database writer(path, Mode::read_write); }
  EXPECT_EQ(error_of(reading), "no error");
}

TEST(MigrationFrom3, KeepsDecisionsAndTheirMeaning) {
  const TemporaryFolder folder;
  const auto path = folder / "old.db";
  rows(path, schema_3);
  rows(path, R"sql(
PRAGMA journal_mode = WAL;
INSERT INTO attempt VALUES
  (1, 'CB4', 'BDR', 0, 100, 'slide', 110, 'approved', 'good', '{}', 'c', '0.1'),
  (2, 'CB4', 'BDR', 50, 150, 'slide', 160, 'waiting', 'better', '{}', 'c', '0.1');
INSERT INTO version (spacecraft, equipment, number, attempt, model_json, digest) VALUES
  ('CB4', 'BDR', 1, 1, '{"a":1}', 'd1'), ('CB4', 'BDR', 2, 2, '{"a":2}', 'd2');
INSERT INTO decision VALUES
  (1, 'CB4', 'BDR', 1, 'approve', 'gate', 'good', 110),
  (2, 'CB4', 'BDR', 2, 'wait', 'gate', 'better', 160);
)sql");
  Database database(path, Mode::read_write);
  Registry registry(database);
  EXPECT_EQ(registry.decide("CB4", "BDR", 2, {DecisionKind::approve, "Ana", "fine"}, 170), 3);
  EXPECT_THAT(rows(path, "SELECT version, status, parent FROM model_version"),
              ElementsAre("1|superseded|NULL", "2|approved|1"));
  EXPECT_EQ(registry.decisions("CB4", "BDR").front().evidence_json, "");
  { const Database made(folder / "new.db", Mode::read_write); }
  const char* schema = "SELECT type, name, sql FROM sqlite_master ORDER BY type, name";
  EXPECT_THAT(rows(path, schema), ElementsAreArray(rows(folder / "new.db", schema)));
}

// Version 5 differs from 4 in the qualities that a file may hold, 6 has the records of versions,
// 7 what the service noticed, 8 what two services of a pair share and the effects of biases, 9
// shards, and 10 no unit that is not known.
TEST(MigrationFrom4To9, AddsTheRecordsAndChangesNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder / "old.db";
  const char* schema = "SELECT type, name, sql FROM sqlite_master ORDER BY type, name";
  {
    Database made(path, Mode::read_write);
    Registry registry(made);
    NewAttempt attempt;
    attempt.spacecraft = "CB4";
    attempt.equipment = "BDR";
    attempt.outcome = "approved";
    registry.record(attempt, {"{}", "d"}, {DecisionKind::approve, "gate", "good"});
    attempt.outcome = "on_probation";
    registry.record(attempt, {"{}", "e"}, {DecisionKind::wait, "gate", "not long enough"});
  }
  const auto before = rows(path, schema);
  const std::string without_records = "DROP TABLE block; DROP TABLE score; DROP VIEW gate_reason; ";
  const std::string without_notices =
      "DROP VIEW alarm_now; DROP VIEW simulator_now; DROP TABLE alarm; DROP TABLE change; "
      "DROP TABLE simulator; DROP INDEX decision_with_why; DROP INDEX attempt_left_waiting; ";
  std::string without_pairs =
      "DROP VIEW overruled_decision; DROP TABLE term; DROP TABLE journal; DROP TABLE overruled; ";
  for (const char* table : {"attempt", "version", "decision", "hold", "command", "alarm", "change",
                            "simulator", "block", "score"})
    without_pairs += "DROP TRIGGER " + std::string(table) + "_journal; ";
  const std::string without_effects = "ALTER TABLE score DROP COLUMN bias_effects; ";
  const std::string without_shards = "DROP TABLE shard; ALTER TABLE chunk DROP COLUMN shard; ";
  const std::string series_view_of_9 =
      "DROP VIEW telemetry_series; CREATE VIEW telemetry_series AS SELECT unit FROM parameter; ";
  for (const std::string old : {"4", "5", "6", "7", "8", "9"}) {
    rows(path, series_view_of_9 + (old == "9" ? "" : without_shards) +
                   (old >= "8" ? "" : without_pairs) +
                   (old >= "8"   ? ""
                    : old >= "6" ? without_effects
                                 : without_records) +
                   (old >= "7" ? "" : without_notices) + "PRAGMA user_version = " + old);
    Database migrated(path, Mode::read_write);
    EXPECT_THAT(rows(path, schema), ElementsAreArray(before));
    EXPECT_THAT(rows(path, "PRAGMA user_version"), ElementsAre(std::to_string(schema::version)));
    EXPECT_THAT(rows(path, "SELECT version, status FROM model_version"),
                ElementsAre("1|approved", "2|waiting"));
    Registry registry(migrated);
    Block block;
    block.range = {0, 60};
    if (old < "6") registry.record_scores("CB4", "BDR", block, {});
    EXPECT_EQ(registry.blocks("CB4", "BDR", INT64_MIN).size(), 1);
    EXPECT_TRUE(registry.alarms().empty());
  }
}

// Three series of several chunks each: a ramp of unusual values, one sample, a long one.
TEST(MigrationFrom2, PutsEverySampleIntoAChunk) {
  const TemporaryFolder folder;
  const auto path = folder / "old.db";
  rows(path, schema_2);
  rows(path, R"sql(
PRAGMA journal_mode = WAL;
INSERT INTO source (id, spacecraft, name, origin) VALUES (4, 'CB4', 'station', 0);
INSERT INTO series VALUES (1, 'CB4', 0, 7, 20000, 0, 19999000), (2, 'CB4', 1, 7, 1, -5, -5),
                          (3, 'CB4', 0, 8, 3, 1, 9);
WITH RECURSIVE n(i) AS (VALUES (0) UNION ALL SELECT i + 1 FROM n WHERE i < 19999)
INSERT INTO sample SELECT 1, i * 1000, i / 8.0, i % 1000 = 0, 4 FROM n;
INSERT INTO sample VALUES (2, -5, -0.0, 3, 4), (3, 1, NULL, 3, 4), (3, 4, 9e999, 3, 4),
                          (3, 9, 0.1, 2, 4);
)sql");
  Database database(path, Mode::read_write);
  const Archive archive(database);
  const Series ramp = archive.read_with_sources("CB4", Origin::real, 7, {0, 20'000'000});
  ASSERT_EQ(ramp.time.size(), 20000U);
  for (std::size_t i = 0; i < ramp.time.size(); ++i) {
    ASSERT_EQ(ramp.time[i], static_cast<Time>(i) * 1000);
    ASSERT_EQ(ramp.value[i], static_cast<double>(i) / 8);
    ASSERT_EQ(ramp.quality[i], i % 1000 == 0 ? Quality::out_of_limits : Quality::good);
    ASSERT_EQ(ramp.source[i], 4);
  }
  EXPECT_TRUE(std::signbit(archive.read("CB4", Origin::simulated, 7, {-9, 0}).value.at(0)));
  const Series odd = archive.read("CB4", Origin::real, 8, {0, 10});
  ASSERT_EQ(odd.value.size(), 3U);
  EXPECT_TRUE(std::isnan(odd.value[0]));
  EXPECT_TRUE(std::isinf(odd.value[1]));
  EXPECT_EQ(odd.value[2], 0.1);
  EXPECT_EQ(odd.quality[2], Quality::suspect);
  EXPECT_THAT(rows(path,
                   "SELECT series, count(*), sum(samples), max(samples) FROM chunk GROUP BY series;"
                   "SELECT count(*) FROM sample_gap; PRAGMA integrity_check"),
              ElementsAre("1|2|20000|12288", "2|1|1|1", "3|1|3|3", "0", "ok"));
}

}  // namespace
}  // namespace reident::storage::test::migration_test
