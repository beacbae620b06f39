// The loadable extension through SQLite's own door: rows, errors, and a writer next to the reader.
// What conditions and orders give is compared with a plain table in
// sql_extension_property_test.cpp.
#include <cmath>
#include <limits>
#include <thread>

#include "tests/storage/fixture.hpp"
#include "tests/storage/sql/sql_user.hpp"

namespace reident::storage::test::sql_extension_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr Time second = 1'000'000'000;
constexpr double infinity = std::numeric_limits<double>::infinity();
using Texts = std::vector<std::string>;

ParameterDescriptor descriptor(std::uint32_t id, const char* name) {
  ParameterDescriptor descriptor;
  descriptor.spacecraft = "CB4";
  descriptor.id = id;
  descriptor.name = name;
  return descriptor;
}

class SqlExtensionTest : public ArchiveTest {
 protected:
  void SetUp() override {
    const ParameterDescriptor bus = descriptor(1, "V_BUS");
    archive.describe(std::span(&bus, 1));
  }
  /// Samples 0 to `count` - 1 of V_BUS, one a second, each the value of its number.
  void append_ramp(Time count, double offset = 0) {
    std::vector<TelemetryFrame> frames;
    for (Time i = 0; i < count; ++i)
      frames.push_back(frame(static_cast<std::uint64_t>(i), i * second,
                             {{1, Quality::good, static_cast<double>(i) + offset}}));
    append(frames);
  }
  Texts ask(const std::string& sql) const { return SqlUser(path).ask(sql); }
};

TEST_F(SqlExtensionTest, TelemetryHasARowForEachSample) {
  TelemetryFrame simulated = frame(1, -1, {{1, Quality::suspect, 27}});
  simulated.origin = Origin::simulated;
  simulated.source = "simcbers";
  append({frame(1, 1'500'000'000, {{1, Quality::good, 28.5}, {2, Quality::out_of_limits, 0}}),
          frame(2, 1'511'222'333'444'555'666, {{1, Quality::good, std::nan("")}}), simulated});
  EXPECT_THAT(ask("SELECT * FROM telemetry ORDER BY origin, parameter, time"),
              ElementsAre("CB4|2|station|1500000000|0|out of limits",
                          "CB4|V_BUS|station|1500000000|28.5|good",
                          "CB4|V_BUS|station|1511222333444555666|NULL|invalid",
                          "CB4|V_BUS|simcbers|-1|27|suspect"));
  EXPECT_THAT(
      ask("SELECT origin, utc FROM telemetry WHERE parameter = 'V_BUS' ORDER BY utc"),
      ElementsAre("simulated|1969-12-31T23:59:59.999999999Z", "real|1970-01-01T00:00:01.500000000Z",
                  "real|2017-11-20T23:58:53.444555666Z"));
}

TEST_F(SqlExtensionTest, EachQualityIsShownAndAskedForByItsName) {
  std::vector<TelemetryFrame> frames;
  for (const Quality quality : qualities)
    frames.push_back(frame(frames.size(), wire_value(quality), {{1, quality, 28.5}}));
  append(frames);
  for (int i = 0; i < 2; ++i, archive.compact())
    for (const Quality quality : qualities) {
      const std::string text(name(quality)), time = std::to_string(wire_value(quality));
      EXPECT_THAT(ask("SELECT time, quality FROM telemetry WHERE quality = '" + text + "'"),
                  ElementsAre(time + "|" + text));
      EXPECT_THAT(ask("SELECT first_time, samples FROM telemetry_summary(NULL, NULL, NULL, '" +
                      text + "')"),
                  ElementsAre(time + "|1"));
      EXPECT_THAT(ask("SELECT * FROM telemetry_summary(NULL, NULL, NULL, 'fine')"),
                  ElementsAre(HasSubstr("'" + text + "'")));
    }
}

TEST_F(SqlExtensionTest, EveryValueComesBackAsItIs) {
  append({frame(1, 1, {{1, Quality::good, -0.0}}), frame(2, 2, {{1, Quality::good, infinity}}),
          frame(3, 3, {{1, Quality::good, -infinity}}), frame(4, 4, {{1, Quality::good, 0.1}})});
  const Texts expected = {"-0|real", "inf|real", "-inf|real", "0.10000000000000001|real"};
  EXPECT_EQ(ask("SELECT value, typeof(value) FROM telemetry"), expected);
  archive.compact();
  EXPECT_EQ(ask("SELECT value, typeof(value) FROM telemetry"), expected);
}

TEST_F(SqlExtensionTest, TheExtremesOfTimeAreTimesLikeOthers) {
  append({frame(1, std::numeric_limits<Time>::min(), {{1, Quality::good, 1}}),
          frame(2, std::numeric_limits<Time>::max(), {{1, Quality::good, 2}}),
          frame(3, std::numeric_limits<Time>::max() - 1, {{1, Quality::good, 3}})});
  for (int i = 0; i < 2; ++i, archive.compact()) {
    EXPECT_THAT(ask("SELECT value, utc FROM telemetry ORDER BY time DESC"),
                ElementsAre("2|2262-04-11T23:47:16.854775807Z", "3|2262-04-11T23:47:16.854775806Z",
                            "1|1677-09-21T00:12:43.145224192Z"));
    EXPECT_THAT(ask("SELECT value FROM telemetry WHERE time < 9223372036854775807"),
                ElementsAre("1", "3"));
    EXPECT_THAT(ask("SELECT samples FROM telemetry_summary(NULL, NULL, 3)"), ElementsAre("1", "2"));
  }
}

TEST_F(SqlExtensionTest, AParameterWithoutADescriptorIsNamedByItsId) {
  append({frame(1, 10, {{7, Quality::good, 5}})});
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE spacecraft = 'CB4' AND parameter = '7'"),
              ElementsAre("5"));
  const ParameterDescriptor battery = descriptor(7, "V_BAT1");
  archive.describe(std::span(&battery, 1));
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE spacecraft = 'CB4' AND parameter = '7'"),
              IsEmpty());
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE spacecraft = 'CB4' AND parameter = 'V_BAT1'"),
              ElementsAre("5"));
}

TEST_F(SqlExtensionTest, TwoParametersOfOneNameAreBothShown) {
  const ParameterDescriptor other = descriptor(2, "V_BUS");
  archive.describe(std::span(&other, 1));
  append({frame(1, 10, {{1, Quality::good, 5}, {2, Quality::good, 6}})});
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE parameter = 'V_BUS' AND spacecraft = 'CB4'"),
              ElementsAre("5", "6"));
  // Rows of one name and time are still two where conditions are looked up one by one.
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE time = 10 OR (time > 5 AND time < 11) "
                  "OR (spacecraft = 'CB4' AND utc = '1970')"),
              ElementsAre("5", "6"));
}

TEST_F(SqlExtensionTest, OtherCollationsAreHonoured) {
  append({frame(1, 10, {{1, Quality::good, 5}})});
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE parameter = 'v_bus'"), IsEmpty());
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE parameter = 'v_bus' COLLATE NOCASE"),
              ElementsAre("5"));
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE utc = '1970-01-01t00:00:00.000000010z' "
                  "COLLATE NOCASE"),
              ElementsAre("5"));
}

TEST_F(SqlExtensionTest, WhatIsUnknownHasNoRows) {
  append_ramp(3);
  for (const char* condition :
       {"spacecraft = 'CB5'", "parameter = 'V_BAT1'", "spacecraft = 'CB4' AND parameter = 'X'",
        "parameter IN ('X', NULL)", "origin = 'simulated'", "source = 'kiruna'", "quality = 'bad'",
        "time > 3e9", "time BETWEEN 5 AND 4", "time = NULL", "time > 9e99", "utc < '1960'",
        "value > 5", "value = 0.5"})
    EXPECT_THAT(ask(std::string("SELECT * FROM telemetry WHERE ") + condition), IsEmpty())
        << condition;
}

TEST_F(SqlExtensionTest, ConditionsAndOrderAreTakenOver) {
  append_ramp(3);
  const auto plan = [this](const std::string& sql) {
    return ::testing::PrintToString(ask("EXPLAIN QUERY PLAN " + sql));
  };
  for (const char* order :
       {"ORDER BY time", "ORDER BY time DESC", "ORDER BY utc", "ORDER BY parameter, time",
        "ORDER BY spacecraft DESC, origin, time DESC, parameter", "GROUP BY parameter",
        "GROUP BY spacecraft, parameter"})
    EXPECT_THAT(plan(std::string("SELECT parameter, max(value) FROM telemetry ") + order),
                Not(HasSubstr("B-TREE")))
        << order;
  // The conditions on the outer table come first, the samples last.
  EXPECT_THAT(
      plan("SELECT telemetry.value FROM telemetry JOIN telemetry_gap AS gap USING (spacecraft) "
           "WHERE parameter = 'V_BUS' AND time > time_before AND time < time_after"),
      HasSubstr("SCAN telemetry VIRTUAL TABLE INDEX"));
  EXPECT_THAT(SqlUser(path).ask("EXPLAIN QUERY PLAN SELECT telemetry.value FROM telemetry "
                                "JOIN sequence_gap AS gap WHERE time > gap.time_before"),
              ElementsAre(HasSubstr("SCAN gap"), HasSubstr("SCAN telemetry VIRTUAL TABLE")));
}

TEST_F(SqlExtensionTest, LateSamplesLieOverTheChunks) {
  append_ramp(100);
  archive.compact();
  append({frame(200, 10 * second + 1, {{1, Quality::good, -5}}),
          frame(201, 20 * second, {{1, Quality::invalid, -6}})});  // a conflict: the first stays
  append({frame(202, -7 * second, {{1, Quality::good, -7}})});
  const std::string question =
      "SELECT time, value FROM telemetry WHERE time < 12000000000 AND (time < 0 OR time > "
      "9000000000) ORDER BY time";
  const Texts expected = {"-7000000000|-7", "10000000000|10", "10000000001|-5", "11000000000|11"};
  EXPECT_EQ(ask(question), expected);
  EXPECT_EQ(ask(question + " DESC"), Texts(expected.rbegin(), expected.rend()));
  EXPECT_THAT(ask("SELECT count(*) FROM telemetry"), ElementsAre("102"));
  EXPECT_THAT(ask("SELECT samples, least, greatest FROM telemetry_summary"),
              ElementsAre("102|-7|99"));
}

TEST_F(SqlExtensionTest, ABetterValueThatCameLaterStandsInForTheOneInItsChunk) {
  append({frame(1, 10, {{1, Quality::suspect, 1}}), frame(2, 20, {{1, Quality::good, 2}})});
  archive.compact();
  append({frame(3, 10, {{1, Quality::good, 9}})});
  EXPECT_THAT(ask("SELECT time, value, quality FROM telemetry"),
              ElementsAre("10|9|good", "20|2|good"));
  EXPECT_THAT(ask("SELECT time FROM telemetry WHERE value < 2"), IsEmpty());
  EXPECT_THAT(ask("SELECT least, greatest FROM telemetry_summary"), ElementsAre("2|9"));
}

// Their chunks hold more samples than the blocks that are merged, which are then read in parts.
TEST(SqlExtension, ManySeriesAreMergedInParts) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database, {.chunk_samples = 60'000});
  constexpr Time parameters = 24, frames = 50'000;
  std::vector<TelemetryFrame> batch;
  for (Time i = 0; i < frames; ++i) {
    TelemetryFrame& one = batch.emplace_back(frame(static_cast<std::uint64_t>(i), i, {}));
    for (std::uint32_t parameter = 0; parameter < parameters; ++parameter)
      one.samples.push_back({parameter, Quality::good, static_cast<double>(i)});
  }
  archive.append(batch);
  archive.compact();
  const SqlUser user(folder / "a.db");
  for (const std::string order : {"", " DESC"}) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(user.handle(),
                       ("SELECT time, value FROM telemetry ORDER BY time" + order).c_str(), -1,
                       &statement, nullptr);
    Time row = 0;
    for (; sqlite3_step(statement) == SQLITE_ROW; ++row) {
      const Time time = order.empty() ? row / parameters : frames - 1 - row / parameters;
      if (sqlite3_column_int64(statement, 0) != time ||
          sqlite3_column_double(statement, 1) != static_cast<double>(time))
        break;
    }
    sqlite3_finalize(statement);
    EXPECT_EQ(row, frames * parameters) << order;
  }
}

TEST_F(SqlExtensionTest, ASummaryHasARowForEachSeriesAndStep) {
  append_ramp(200, 0.5);
  TelemetryFrame simulated = frame(1, 3 * second, {{1, Quality::suspect, -1}});
  simulated.origin = Origin::simulated;
  append({simulated});
  for (int i = 0; i < 2; ++i, archive.compact()) {
    EXPECT_THAT(
        ask("SELECT * FROM telemetry_summary(0, 4e9)"),
        ElementsAre("CB4|V_BUS|real|NULL|0|3000000000|4|2|0.5|3.5|0.5|3.5|0|3000000000|good",
                    "CB4|V_BUS|simulated|NULL|3000000000|3000000000|1|-1|-1|-1|-1|-1|3000000000|"
                    "3000000000|suspect"));
    EXPECT_THAT(
        ask("SELECT utc, samples, mean FROM telemetry_summary('1970-01-01 00:01', NULL, "
            "'1min') WHERE parameter = 'V_BUS'"),
        ElementsAre("1970-01-01T00:01:00.000000000Z|60|90", "1970-01-01T00:02:00.000000000Z|60|150",
                    "1970-01-01T00:03:00.000000000Z|20|190"));
    EXPECT_THAT(ask("SELECT origin, samples FROM telemetry_summary(NULL, NULL, NULL, 'suspect')"),
                ElementsAre("simulated|1"));
    EXPECT_THAT(ask("SELECT name, mean FROM (SELECT 'all' AS name, 0 AS first, 2000000000 AS last "
                    "UNION SELECT 'none', 5, 5) JOIN telemetry_summary(first, last)"),
                ElementsAre("all|1"));
  }
}

TEST_F(SqlExtensionTest, ASummaryHasTheFirstTimesOfItsExtremesAndTheWorstQuality) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const double values[] = {4.5, 4, 9, 1, 9, 1, 5, nan, nan, 7};
  const Quality worst[] = {Quality::out_of_limits, Quality::invalid};
  for (int i = 0; i < 10; ++i)
    append({frame(static_cast<std::uint64_t>(i + 1), i * second,
                  {{1, i % 5 == 2 ? worst[i / 5] : Quality::good, values[i]}})});
  for (int i = 0; i < 2; ++i, archive.compact()) {
    EXPECT_THAT(ask("SELECT least, least_time, greatest, greatest_time, worst_quality "
                    "FROM telemetry_summary(NULL, NULL, '5s')"),
                ElementsAre("1|3000000000|9|2000000000|out of limits",
                            "1|5000000000|7|9000000000|invalid"));
    EXPECT_THAT(ask("SELECT least_time, worst_quality FROM telemetry_summary(7e9, 9e9)"),
                ElementsAre("NULL|invalid"));
    EXPECT_THAT(ask("SELECT worst_quality FROM telemetry_summary"), ElementsAre("invalid"));
  }
}

TEST_F(SqlExtensionTest, ASummaryRefusesArgumentsThatMeanNothing) {
  const std::pair<const char*, const char*> table[] = {
      {"'yesterday'", "begin_time is 'yesterday': give nanoseconds since 1970, or UTC"},
      {"NULL, '2026'", "end_time is '2026': give nanoseconds"},
      {"x'00'", "begin_time is"},
      {"0, 1, 0", "step is '0': give nanoseconds above 0"},
      {"0, 1, -5", "step is '-5'"},
      {"0, 1, 1.5", "step is '1.5'"},
      {"0, 1, '5 parsecs'", "step is '5 parsecs'"},
      {"0, 1, '99999999999d'", "step is '99999999999d'"},
      {"0, 1, 2, 'fine'", "quality is 'fine': give 'good', 'out of limits'"}};
  for (const auto& [arguments, message] : table)
    EXPECT_THAT(ask(std::string("SELECT * FROM telemetry_summary(") + arguments + ")"),
                ElementsAre(HasSubstr(message)));
}

TEST_F(SqlExtensionTest, AFileThatIsNoArchiveIsNamed) {
  const SqlUser user(folder / "other.db");
  user.ask("CREATE TABLE something (x)");
  EXPECT_THAT(user.ask("SELECT * FROM telemetry"),
              ElementsAre(AllOf(HasSubstr("other.db is not a reident archive"),
                                HasSubstr("open the archive itself"))));
}

TEST_F(SqlExtensionTest, AnotherSchemaIsRefusedWithTheRemedy) {
  const SqlUser user(folder / "other.db");
  user.ask("PRAGMA application_id = 0x72656964");
  user.ask("PRAGMA user_version = 2");
  EXPECT_THAT(user.ask("SELECT * FROM telemetry"),
              ElementsAre(AllOf(HasSubstr("other.db has schema version 2"),
                                HasSubstr("start this version's reidentd"))));
  user.ask("PRAGMA user_version = 1000");
  EXPECT_THAT(user.ask("SELECT * FROM telemetry_summary"),
              ElementsAre(HasSubstr("load the extension of the reident that writes the file")));
}

TEST_F(SqlExtensionTest, ADamagedChunkEndsTheQuestionAndIsNamed) {
  append_ramp(100);
  archive.compact();
  const std::string flip =
      "UPDATE chunk_data SET bytes = CAST(substr(bytes, 1, 90) || x'ff' || substr(bytes, 92) AS "
      "BLOB)";
  rows(path, flip);
  for (const char* question : {"SELECT value FROM telemetry", "SELECT mean FROM telemetry_summary",
                               "SELECT value FROM telemetry ORDER BY time DESC LIMIT 1"})
    EXPECT_THAT(ask(question),
                ElementsAre(AllOf(HasSubstr("error 267: telemetry: the samples of V_BUS of CB4 "
                                            "(real) from 1970-01-01T00:00:00.000000000Z to "
                                            "1970-01-01T00:01:39.000000000Z in "),
                                  HasSubstr("does not match its checksum"),
                                  HasSubstr("'reident verify " + path.string() + "'"))));
  rows(path, "DELETE FROM chunk_data");
  EXPECT_THAT(ask("SELECT value FROM telemetry"), ElementsAre(HasSubstr("is cut short")));
}

TEST_F(SqlExtensionTest, ADamagedFragmentEndsTheQuestionToo) {
  append_ramp(10);
  rows(path, "UPDATE recent SET data = substr(data, 1, 20)");
  EXPECT_THAT(ask("SELECT value FROM telemetry"), ElementsAre(HasSubstr("'reident verify")));
  EXPECT_THAT(ask("SELECT value FROM telemetry WHERE time > 20000000000"), IsEmpty());
}

TEST_F(SqlExtensionTest, ADamagedNumberOfABatchIsNamedAndNotCountedUpTo) {
  append_ramp(10);
  append_ramp(20);
  rows(path, "UPDATE recent SET batch = 9000000000000000000 WHERE batch = 2");
  for (const char* question : {"SELECT value FROM telemetry", "SELECT mean FROM telemetry_summary"})
    EXPECT_THAT(ask(question), ElementsAre(AllOf(HasSubstr("error 267: telemetry: "),
                                                 HasSubstr("'reident verify"))));
}

TEST_F(SqlExtensionTest, AStatementSeesOneStateOfTheFileWhateverIsWritten) {
  append_ramp(50);
  const SqlUser user(path);
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(user.handle(), "SELECT time FROM telemetry", -1, &statement, nullptr);
  ASSERT_EQ(sqlite3_step(statement), SQLITE_ROW);
  append({frame(900, 900 * second, {{1, Quality::good, 1}})});
  archive.compact();
  int seen = 1;
  while (sqlite3_step(statement) == SQLITE_ROW) ++seen;
  sqlite3_finalize(statement);
  EXPECT_EQ(seen, 50);
  EXPECT_THAT(user.ask("SELECT count(*) FROM telemetry"), ElementsAre("51"));
}

TEST_F(SqlExtensionTest, AReaderSeesWholeBatchesWhileAnotherProcessAppends) {
  append_ramp(1);
  const std::filesystem::path file = path;
  const std::filesystem::path started = folder / "started";
  const auto reader = [file, started] {
    write_file(started, "");
    const SqlUser user(file);
    for (int last = 0; last < 200;) {
      // Each batch has ten samples a parameter, of equal values.
      const Texts found = user.ask(
          "SELECT count(*), sum(value), (SELECT samples FROM telemetry_summary WHERE parameter = "
          "'2'), (SELECT count(*) FROM (SELECT * FROM telemetry WHERE parameter IN ('2', '3') "
          "ORDER BY time DESC)) FROM telemetry WHERE parameter = '2'");
      if (found.size() != 1) return found.back();
      const int count = std::atoi(found[0].c_str());
      const std::string expected =
          std::to_string(count) + "|" + (count > 0 ? std::to_string(count * 7) : "NULL") + "|" +
          (count > 0 ? std::to_string(count) : "NULL") + "|" + std::to_string(2 * count);
      if (count % 10 != 0 || count < last || found[0] != expected) return found[0];
      last = count;
    }
    return std::string("all seen");
  };
  // The writer goes on in this process while the child reads.
  std::string answer;
  std::thread child([&] { answer = in_child(reader); });
  while (!std::filesystem::exists(started)) std::this_thread::yield();
  for (std::uint64_t batch = 0; batch < 25; ++batch) {
    std::vector<TelemetryFrame> frames;
    for (std::uint64_t i = 0; i < 10; ++i)
      frames.push_back(frame(batch * 10 + i, static_cast<Time>(batch * 10 + i) * second,
                             {{2, Quality::good, 7}, {3, Quality::good, 8}}));
    append(frames);
    if (batch % 5 == 4) archive.compact();
  }
  child.join();
  EXPECT_EQ(answer, "all seen");
}

TEST_F(SqlExtensionTest, AViewMayBeMadeOfIt) {
  append_ramp(3);
  const SqlUser user(path);
  user.ask("CREATE TEMP VIEW bus AS SELECT time, value FROM telemetry WHERE parameter = 'V_BUS'");
  EXPECT_THAT(user.ask("SELECT value FROM bus WHERE time >= 2000000000"), ElementsAre("2"));
  EXPECT_THAT(user.ask("DELETE FROM telemetry"), ElementsAre(HasSubstr("may not be modified")));
  EXPECT_THAT(user.ask("CREATE VIRTUAL TABLE mine USING telemetry"),
              ElementsAre(HasSubstr("no such module")));
}

}  // namespace
}  // namespace reident::storage::test::sql_extension_test
