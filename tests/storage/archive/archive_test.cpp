#include "storage/archive/archive.hpp"

#include <cmath>
#include <limits>

#include "storage/database/connection.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::archive_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::NanSensitiveDoubleEq;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Time least = std::numeric_limits<Time>::min();
constexpr Time most = std::numeric_limits<Time>::max();

TEST_F(ArchiveTest, StartsEmpty) {
  EXPECT_EQ(archive.sample_count(), 0U);
  EXPECT_THAT(archive.spacecraft(), IsEmpty());
  EXPECT_THAT(archive.sources(), IsEmpty());
  EXPECT_THAT(archive.sequence_gaps(), IsEmpty());
  EXPECT_EQ(archive.extent("CB4", Origin::real), std::nullopt);
  EXPECT_THAT(read_all(archive, 1).time, IsEmpty());
}

TEST_F(ArchiveTest, GivesBackWhatWasAppendedInOrderOfTime) {
  append({frame(1, 10, {{1, Quality::good, 28.5}, {2, Quality::suspect, 0.0}}),
          frame(2, 20, {{1, Quality::out_of_limits, 31.0}})});
  append({frame(3, 30, {{1, Quality::good, 28.25}})});
  const Series series = read_all(archive, 1);
  EXPECT_THAT(series.time, ElementsAre(10, 20, 30));
  EXPECT_THAT(series.value, ElementsAre(28.5, 31.0, 28.25));
  EXPECT_THAT(series.quality, ElementsAre(Quality::good, Quality::out_of_limits, Quality::good));
  EXPECT_THAT(read_all(archive, 2).value, ElementsAre(0.0));
  EXPECT_EQ(archive.sample_count(), 4U);
}

TEST_F(ArchiveTest, ReadsHalfOpenRanges) {
  append({frame(1, 10, {{1, Quality::good, 1}}), frame(2, 20, {{1, Quality::good, 2}}),
          frame(3, 30, {{1, Quality::good, 3}})});
  const struct {
    TimeRange range;
    std::vector<Time> times;
  } table[] = {
      {{10, 30}, {10, 20}}, {{11, 30}, {20}},       {{10, 31}, {10, 20, 30}}, {{20, 21}, {20}},
      {{20, 20}, {}},       {{30, 10}, {}},         {{31, most}, {}},         {{least, 10}, {}},
      {{least, 11}, {10}},  {{20, most}, {20, 30}}, {{least, least}, {}},
  };
  for (const auto& [range, times] : table)
    EXPECT_EQ(archive.read("CB4", Origin::real, 1, range).time, times)
        << "[" << range.begin << ", " << range.end << ")";
}

TEST_F(ArchiveTest, LooksUpWhatItReadsAndScansNoTable) {
  for (unsigned batch = 1; batch <= 300; ++batch)
    append({frame(batch, 10 * batch, {{1, Quality::good, 1}})});
  sqlite3* handle = connection(database).handle();
  EXPECT_EQ(archive.read("CB4", Origin::real, 1, {2990, most}).time.size(), 2U);
  int scanned = 0;
  for (sqlite3_stmt* one = sqlite3_next_stmt(handle, nullptr); one;
       one = sqlite3_next_stmt(handle, one))
    if (const std::string sql = sqlite3_sql(one); sql.find("recent") != std::string::npos)
      scanned += sqlite3_stmt_status(one, SQLITE_STMTSTATUS_FULLSCAN_STEP, 0);
  EXPECT_EQ(scanned, 0);
}

TEST_F(ArchiveTest, FindsTheNearestSampleOnEitherSide) {
  append({frame(1, 10, {{1, Quality::good, 1}}), frame(2, 15, {{2, Quality::good, 1}}),
          frame(3, 20, {{1, Quality::good, 2}})});
  const struct {
    Time time;
    std::optional<Time> before, after;
  } table[] = {
      {9, {}, 10},  {10, 10, 10}, {11, 10, 20},    {19, 10, 20},
      {20, 20, 20}, {21, 20, {}}, {least, {}, 10}, {most, 20, {}},
  };
  for (const auto& [time, before, after] : table) {
    EXPECT_EQ(archive.last_at_or_before("CB4", Origin::real, 1, time), before) << time;
    EXPECT_EQ(archive.first_at_or_after("CB4", Origin::real, 1, time), after) << time;
  }
  EXPECT_EQ(archive.last_at_or_before("CB4", Origin::simulated, 1, 15), std::nullopt);
  EXPECT_EQ(archive.first_at_or_after("CB4A", Origin::real, 1, 15), std::nullopt);
}

TEST_F(ArchiveTest, KeepsTheExtremesOfTime) {
  append({frame(1, most, {{1, Quality::good, 2}}), frame(2, least, {{1, Quality::good, 1}})});
  EXPECT_THAT(read_all(archive, 1).time, ElementsAre(least, most));
  EXPECT_THAT(archive.read("CB4", Origin::real, 1, {least, most - 1}).time, ElementsAre(least));
  EXPECT_THAT(archive.read("CB4", Origin::real, 1, {most, most}).time, ElementsAre(most));
  EXPECT_EQ(archive.extent("CB4", Origin::real), (TimeRange{least, most}));
}

TEST_F(ArchiveTest, KeepsEveryBitOfAFiniteValue) {
  const std::vector<double> values{0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   0.1,
                                   1e300,
                                   std::numeric_limits<double>::denorm_min(),
                                   -std::numeric_limits<double>::max(),
                                   9007199254740993.0,
                                   std::nextafter(1.0, 2.0)};
  for (std::size_t i = 0; i < values.size(); ++i)
    append({frame(i, static_cast<Time>(i), {{1, Quality::good, values[i]}})});
  const Series series = read_all(archive, 1);
  ASSERT_EQ(series.value.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(series.value[i], values[i]);
    EXPECT_EQ(std::signbit(series.value[i]), std::signbit(values[i])) << values[i];
  }
}

TEST_F(ArchiveTest, StoresWhatIsNotFiniteAsInvalidAndCountsIt) {
  const AppendReport report =
      append({frame(1, 1, {{1, Quality::good, nan}}), frame(2, 2, {{1, Quality::good, infinity}}),
              frame(3, 3, {{1, Quality::suspect, -infinity}})});
  EXPECT_EQ(report.stored, 3U);
  EXPECT_EQ(report.non_finite, 3U);
  const Series series = read_all(archive, 1);
  EXPECT_THAT(series.value, ElementsAre(NanSensitiveDoubleEq(nan), infinity, -infinity));
  EXPECT_THAT(series.quality, ::testing::Each(Quality::invalid));
}

TEST_F(ArchiveTest, TakesAQualityBeyondTheKnownOnesAsInvalid) {
  append({frame(1, 1, {{1, static_cast<Quality>(17), 5.0}})});
  EXPECT_THAT(read_all(archive, 1).quality, ElementsAre(Quality::invalid));
}

TEST_F(ArchiveTest, KeepsSeriesOfOriginsSpacecraftAndParametersApart) {
  TelemetryFrame simulated = frame(1, 10, {{1, Quality::good, 2}});
  simulated.origin = Origin::simulated;
  TelemetryFrame other = frame(1, 10, {{1, Quality::good, 3}});
  other.spacecraft = "CB4A";
  const AppendReport report =
      append({frame(1, 10, {{1, Quality::good, 1}, {2, Quality::good, 4}}), simulated, other});
  EXPECT_EQ(report.stored, 4U);
  EXPECT_EQ(report.conflicts, 0U);
  EXPECT_THAT(read_all(archive, 1).value, ElementsAre(1.0));
  EXPECT_THAT(read_all(archive, 1, Origin::simulated).value, ElementsAre(2.0));
  EXPECT_THAT(archive.read("CB4A", Origin::real, 1, {0, 100}).value, ElementsAre(3.0));
  EXPECT_THAT(read_all(archive, 2).value, ElementsAre(4.0));
  EXPECT_THAT(archive.spacecraft(), ElementsAre("CB4", "CB4A"));
}

// What comes second to the same identity, and what is kept of it.
struct Collision {
  const char* what;
  Sample first, second;
  double kept;
  Quality quality;
  bool conflict;
};

TEST_F(ArchiveTest, SettlesTwoSamplesOfOneIdentity) {
  const Collision table[] = {
      {"the same", {1, Quality::good, 5}, {1, Quality::good, 5}, 5, Quality::good, false},
      {"NaN again",
       {1, Quality::good, nan},
       {1, Quality::good, -nan},
       nan,
       Quality::invalid,
       false},
      {"another value, same quality: the first",
       {1, Quality::out_of_limits, 5},
       {1, Quality::out_of_limits, 6},
       5,
       Quality::out_of_limits,
       true},
      {"another good value: nobody can tell which is true",
       {1, Quality::good, 5},
       {1, Quality::good, 6},
       5,
       Quality::disputed,
       true},
      {"better quality wins",
       {1, Quality::suspect, 5},
       {1, Quality::good, 6},
       6,
       Quality::good,
       true},
      {"worse quality loses",
       {1, Quality::out_of_limits, 5},
       {1, Quality::suspect, 6},
       5,
       Quality::out_of_limits,
       true},
      {"a number beats NaN",
       {1, Quality::good, nan},
       {1, Quality::suspect, 6},
       6,
       Quality::suspect,
       true},
      {"NaN never beats a number",
       {1, Quality::suspect, 6},
       {1, Quality::good, nan},
       6,
       Quality::suspect,
       true},
      {"of two invalid ones the first",
       {1, Quality::good, nan},
       {1, Quality::good, infinity},
       nan,
       Quality::invalid,
       true},
      {"same value, better quality",
       {1, Quality::suspect, 5},
       {1, Quality::good, 5},
       5,
       Quality::good,
       false},
      {"same value, worse quality",
       {1, Quality::good, 5},
       {1, Quality::invalid, 5},
       5,
       Quality::good,
       false},
      {"zeros of either sign differ in bits",
       {1, Quality::good, 0.0},
       {1, Quality::good, -0.0},
       0.0,
       Quality::good,
       true},
  };
  for (const bool one_batch : {false, true}) {
    Time time = one_batch ? 1000 : 0;
    for (const Collision& c : table) {
      SCOPED_TRACE(std::string(c.what) + (one_batch ? ", in one batch" : ", in two batches"));
      ++time;
      AppendReport report;
      if (one_batch) {
        report = append({frame(1, time, {c.first}), frame(2, time, {c.second})});
        EXPECT_EQ(report.stored, 1U);
      } else {
        EXPECT_EQ(append({frame(1, time, {c.first})}).stored, 1U);
        report = append({frame(2, time, {c.second})});
        EXPECT_EQ(report.stored, 0U);
      }
      EXPECT_EQ(report.conflicts, c.conflict ? 1U : 0U);
      EXPECT_EQ(report.duplicates, c.conflict ? 0U : 1U);
      const Series kept = archive.read("CB4", Origin::real, 1, {time, time + 1});
      EXPECT_THAT(kept.value, ElementsAre(NanSensitiveDoubleEq(c.kept)));
      EXPECT_THAT(kept.quality, ElementsAre(c.quality));
    }
  }
}

TEST_F(ArchiveTest, KeepsTheBetterOfAnyTwoQualitiesOfOneValue) {
  Time time = 0;
  for (const Quality first : qualities)
    for (const Quality second : qualities) {
      ++time;
      append({frame(1, time, {{1, first, 5}}), frame(2, time, {{1, second, 5}})});
      const bool second_wins = first != Quality::disputed && is_better(second, first);
      EXPECT_THAT(archive.read("CB4", Origin::real, 1, {time, time + 1}).quality,
                  ElementsAre(second_wins ? second : first))
          << name(first) << ", then " << name(second);
    }
}

TEST_F(ArchiveTest, KeepsADisputedSampleSoWhateverComesAgain) {
  append({frame(1, 1, {{1, Quality::good, 5}}), frame(2, 1, {{1, Quality::good, 6}})});
  for (const double value : {5.0, 6.0, 7.0})
    EXPECT_TRUE(append({frame(3, 1, {{1, Quality::good, value}})}).touched.empty()) << value;
  EXPECT_THAT(read_all(archive, 1).value, ElementsAre(5.0));
  EXPECT_THAT(read_all(archive, 1).quality, ElementsAre(Quality::disputed));
}

TEST_F(ArchiveTest, LetsNoFileDisputeWhatWasReceived) {
  append({frame(1, 1, {{1, Quality::good, 5}})});
  TelemetryFrame row = frame(0, 1, {{1, Quality::good, 6}});
  row.numbered = false;
  EXPECT_EQ(append({row}).conflicts, 1U);
  EXPECT_THAT(read_all(archive, 1).value, ElementsAre(5.0));
  EXPECT_THAT(read_all(archive, 1).quality, ElementsAre(Quality::good));
}

TEST_F(ArchiveTest, TakesTheRoundingOfAValueForNoDispute) {
  for (const auto& [time, second] : {std::pair{1, 28.000014}, {2, 28.000056}, {3, -28.0}})
    append(
        {frame(1, time, {{1, Quality::good, 28}}), frame(2, time, {{1, Quality::good, second}})});
  EXPECT_THAT(read_all(archive, 1).quality,
              ElementsAre(Quality::good, Quality::disputed, Quality::disputed));
}

TEST_F(ArchiveTest, LetsASimulatorSayAnotherThingOfTheSameTime) {
  TelemetryFrame simulated = frame(1, 1, {{1, Quality::good, 5}});
  simulated.origin = Origin::simulated;
  TelemetryFrame again = frame(2, 1, {{1, Quality::good, 6}});
  again.origin = Origin::simulated;
  append({simulated, again});
  EXPECT_THAT(read_all(archive, 1, Origin::simulated).value, ElementsAre(5.0));
  EXPECT_THAT(read_all(archive, 1, Origin::simulated).quality, ElementsAre(Quality::good));
}

TEST_F(ArchiveTest, CountsASampleTwiceInOneFrameAsADuplicate) {
  const AppendReport report =
      append({frame(1, 10, {{1, Quality::good, 5}, {1, Quality::good, 5}})});
  EXPECT_EQ(report.stored, 1U);
  EXPECT_EQ(report.duplicates, 1U);
  EXPECT_EQ(archive.sample_count(), 1U);
}

TEST_F(ArchiveTest, CountsAsLateWhatIsStoredBehindANewerSampleOfItsSeries) {
  EXPECT_EQ(append({frame(1, 100, {{1, Quality::good, 1}})}).late, 0U);
  EXPECT_EQ(append({frame(2, 90, {{1, Quality::good, 2}})}).late, 1U);
  EXPECT_EQ(append({frame(3, 90, {{2, Quality::good, 3}})}).late, 0U) << "another series";
  EXPECT_EQ(append({frame(2, 90, {{1, Quality::good, 2}})}).late, 0U)
      << "a duplicate is not stored";
  EXPECT_EQ(append({frame(4, 130, {{1, Quality::good, 4}}), frame(5, 120, {{1, Quality::good, 5}}),
                    frame(6, 110, {{1, Quality::good, 6}})})
                .late,
            2U)
      << "within one batch";
}

TEST_F(ArchiveTest, ReportsTheRangeThatEachSeriesTouched) {
  append({frame(1, 50, {{1, Quality::suspect, 5}, {2, Quality::good, 1}})});
  const AppendReport report =
      append({frame(2, 70, {{1, Quality::good, 7}}), frame(3, 60, {{1, Quality::good, 6}}),
              frame(4, 50, {{1, Quality::good, 5}}), frame(5, 50, {{2, Quality::good, 1}})});
  ASSERT_EQ(report.touched.size(), 1U) << "a duplicate touches nothing";
  EXPECT_EQ(report.touched[0].spacecraft, "CB4");
  EXPECT_EQ(report.touched[0].origin, Origin::real);
  EXPECT_EQ(report.touched[0].parameter, 1U);
  EXPECT_EQ(report.touched[0].range, (TimeRange{50, 71})) << "a better quality is a change";
}

TEST_F(ArchiveTest, CountsEachSourceAndKeepsTheCountsInTheFile) {
  TelemetryFrame second = frame(7, 30, {{1, Quality::good, 3}, {2, Quality::good, nan}});
  second.source = "station B";
  append({frame(1, 10, {{1, Quality::good, 1}}), frame(2, 20, {{1, Quality::good, 2}}), second});
  second.sequence = 8;
  second.samples[0].value = 4;
  append({second, frame(2, 20, {{1, Quality::good, 2}}), frame(3, 15, {{1, Quality::good, 9}})});

  const Database reader(path, Database::Mode::read_only);
  for (const Archive& view : {archive, Archive(const_cast<Database&>(reader))}) {
    const std::vector<SourceCounts> sources = view.sources();
    ASSERT_EQ(sources.size(), 2U);
    const SourceCounts &a = sources[0], &b = sources[1];
    EXPECT_EQ(a.source, "station");
    EXPECT_EQ(a.frames, 4U);
    EXPECT_EQ(a.samples, 4U);
    EXPECT_EQ(a.duplicates, 1U);
    EXPECT_EQ(a.late, 1U);
    EXPECT_EQ(a.out_of_order, 1U);
    EXPECT_EQ(a.last_sequence, 3U);
    EXPECT_EQ(b.source, "station B");
    EXPECT_EQ(b.frames, 2U);
    EXPECT_EQ(b.samples, 4U);
    EXPECT_EQ(b.conflicts, 1U);
    EXPECT_EQ(b.duplicates, 1U) << "NaN again";
    EXPECT_EQ(b.non_finite, 2U);
    EXPECT_EQ(b.missing, 0U);
  }
}

TEST_F(ArchiveTest, TakesEmptyBatchesAndEmptyFrames) {
  EXPECT_EQ(append({}).frames, 0U);
  const AppendReport report = append({frame(1, 10, {}), frame(2, 20, {})});
  EXPECT_EQ(report.frames, 2U);
  EXPECT_EQ(report.stored, 0U);
  ASSERT_EQ(archive.sources().size(), 1U);
  EXPECT_EQ(archive.sources()[0].frames, 2U);
}

TEST_F(ArchiveTest, KeepsNamesWithAnyCharacters) {
  TelemetryFrame odd = frame(1, 10, {{4294967295U, Quality::good, 1}});
  odd.spacecraft = "'; DROP TABLE sample; --";
  odd.source = "Estação\n\"Cuiabá\" 北京";
  append({odd});
  EXPECT_THAT(archive.spacecraft(), ElementsAre(odd.spacecraft));
  EXPECT_EQ(archive.sources()[0].source, odd.source);
  EXPECT_THAT(archive.read(odd.spacecraft, Origin::real, 4294967295U, {0, 100}).value,
              ElementsAre(1.0));
}

TEST_F(ArchiveTest, KnowsTheExtentOfEachOrigin) {
  TelemetryFrame simulated = frame(1, 5, {{1, Quality::good, 1}});
  simulated.origin = Origin::simulated;
  append({frame(1, 20, {{1, Quality::good, 1}}), frame(2, 90, {{2, Quality::good, 1}}), simulated});
  EXPECT_EQ(archive.extent("CB4", Origin::real), (TimeRange{20, 91}));
  EXPECT_EQ(archive.extent("CB4", Origin::simulated), (TimeRange{5, 6}));
  EXPECT_EQ(archive.extent("CB5", Origin::real), std::nullopt);
}

ParameterDescriptor described(std::uint32_t id, const std::string& name) {
  return {.spacecraft = "CB4",
          .id = id,
          .name = name,
          .unit = "V",
          .description = "main bus",
          .kind = ParameterKind::analog,
          .low_limit = 22.5,
          .high_limit = std::nullopt};
}

TEST_F(ArchiveTest, GivesDescriptorsBackAndReplacesThem) {
  ParameterDescriptor bus = described(7, "V_BUS");
  ParameterDescriptor relay = described(3, "RELAY");
  relay.kind = ParameterKind::digital;
  archive.describe(std::vector{bus, relay});
  EXPECT_THAT(archive.parameters("CB4"), ElementsAre(relay, bus));
  bus.name = "V_MAIN";
  bus.low_limit.reset();
  bus.high_limit = 34;
  archive.describe(std::vector{bus});
  EXPECT_THAT(archive.parameters("CB4"), ElementsAre(relay, bus));
  EXPECT_EQ(archive.parameter("CB4", "V_BUS"), std::nullopt);
  EXPECT_EQ(archive.parameter("CB4", "V_MAIN"), bus);
  EXPECT_EQ(archive.parameter("CB5", "V_MAIN"), std::nullopt);
}

TEST_F(ArchiveTest, FindsTheLowestIdOfAnAmbiguousName) {
  archive.describe(std::vector{described(9, "V_BUS"), described(4, "V_BUS")});
  ASSERT_TRUE(archive.parameter("CB4", "V_BUS"));
  EXPECT_EQ(archive.parameter("CB4", "V_BUS")->id, 4U);
}

TEST_F(ArchiveTest, TakesALimitThatIsNotANumberAsNoLimit) {
  ParameterDescriptor bus = described(7, "V_BUS");
  bus.low_limit = nan;
  archive.describe(std::vector{bus});
  EXPECT_EQ(archive.parameter("CB4", "V_BUS")->low_limit, std::nullopt);
}

TEST_F(ArchiveTest, RefusesToWriteThroughAReader) {
  Database reader(path, Database::Mode::read_only);
  Archive view(reader);
  const std::vector frames{frame(1, 10, {{1, Quality::good, 1}})};
  EXPECT_THAT(error_of([&] { view.append(frames); }), ::testing::StartsWith("read_only: "));
  EXPECT_EQ(archive.sample_count(), 0U);
}

}  // namespace
}  // namespace reident::storage::test::archive_test
