// What append() marks below a sealed time, and how the marks are taken away.
#include <limits>

#include "storage/archive/append.hpp"
#include "storage/archive/archive.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::late_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Time second = 1'000'000'000;
constexpr Time minute = 60 * second;
constexpr Time hour = 60 * minute;

class LateTest : public ArchiveTest {
 protected:
  std::uint64_t sequence_ = 0;
  void arrive(Time time, std::uint32_t parameter = 1, double value = 1,
              Quality quality = Quality::good) {
    append({frame(++sequence_, time, {{parameter, quality, value}})});
  }
  std::vector<TimeRange> ranges() const {
    std::vector<TimeRange> ranges;
    for (const LateRange& late : archive.late_ranges("CB4")) ranges.push_back(late.range);
    return ranges;
  }
};

TEST_F(LateTest, MarksNothingBeforeATimeIsSealed) {
  arrive(10 * hour);
  arrive(1 * hour);
  EXPECT_THAT(ranges(), IsEmpty());
}

TEST_F(LateTest, MarksWhatLandsBeforeTheSealAndNothingElse) {
  archive.seal("CB4", 10 * hour);
  arrive(10 * hour);
  arrive(11 * hour);
  EXPECT_THAT(ranges(), IsEmpty());
  arrive(10 * hour - 1);
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{10 * hour - 1, 10 * hour}));
}

TEST_F(LateTest, MarksAFirstSampleOfASeriesToo) {
  archive.seal("CB4", 10 * hour);
  arrive(2 * hour, 7);
  const std::vector<LateRange> late = archive.late_ranges("CB4");
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].parameter, 7U);
  EXPECT_EQ(late[0].origin, Origin::real);
  EXPECT_EQ(late[0].spacecraft, "CB4");
}

TEST_F(LateTest, MarksABetterQualityButNoDuplicateAndNoLostConflict) {
  arrive(1 * hour, 1, 5, Quality::suspect);
  archive.seal("CB4", 10 * hour);
  arrive(1 * hour, 1, 5, Quality::suspect);
  arrive(1 * hour, 1, 6, Quality::suspect);
  EXPECT_THAT(ranges(), IsEmpty());
  arrive(1 * hour, 1, 6, Quality::good);
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{1 * hour, 1 * hour + 1}));
}

TEST_F(LateTest, MarksADisputeAndKeepsWhatWasReadBefore) {
  arrive(1 * hour, 1, 5);
  archive.seal("CB4", 10 * hour);
  arrive(1 * hour, 1, 6);
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{1 * hour, 1 * hour + 1}));
  const auto batches = archive.revisions("CB4", Origin::real, 1, {0, 2 * hour});
  ASSERT_EQ(batches.size(), 1U);
  const Series before = archive.before(batches[0] - 1).read("CB4", Origin::real, 1, {0, 2 * hour});
  EXPECT_THAT(before.quality, ElementsAre(Quality::good));
  EXPECT_THAT(archive.read("CB4", Origin::real, 1, {0, 2 * hour}).quality,
              ElementsAre(Quality::disputed));
}

TEST_F(LateTest, SealsEachSpacecraftAloneAndOnlyForward) {
  archive.seal("CB4A", 20 * hour);
  arrive(1 * hour);
  EXPECT_THAT(ranges(), IsEmpty());
  archive.seal("CB4", 10 * hour);
  archive.seal("CB4", 5 * hour);
  arrive(7 * hour);
  EXPECT_EQ(ranges().size(), 1U);
  EXPECT_THAT(archive.late_ranges("CB4A"), IsEmpty());
}

TEST_F(LateTest, JoinsNearSamplesAndKeepsFarOnesApart) {
  archive.seal("CB4", 100 * hour);
  append({frame(1, 1 * hour, {{1, Quality::good, 1}}),
          frame(2, 1 * hour + 2 * late_merge_distance, {{1, Quality::good, 2}}),
          frame(3, 50 * hour, {{1, Quality::good, 3}}),
          frame(4, 1 * hour + late_merge_distance, {{1, Quality::good, 4}})});
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{1 * hour, 1 * hour + 2 * late_merge_distance + 1},
                                    TimeRange{50 * hour, 50 * hour + 1}));
}

TEST_F(LateTest, JoinsAPlaybackBatchByBatchInEitherDirection) {
  archive.seal("CB4", 100 * hour);
  for (int i = 0; i < 50; ++i) arrive(10 * hour + i * minute);
  for (int i = 1; i < 50; ++i) arrive(10 * hour - i * minute);
  EXPECT_THAT(ranges(),
              ElementsAre(TimeRange{10 * hour - 49 * minute, 10 * hour + 49 * minute + 1}));
  arrive(20 * hour);
  arrive(20 * hour + 2 * late_merge_distance);
  EXPECT_EQ(ranges().size(), 3U);
  arrive(20 * hour + late_merge_distance);
  EXPECT_EQ(ranges().size(), 2U) << "one sample joins its two neighbours";
}

TEST_F(LateTest, ForgetsWhatWasLookedAt) {
  archive.seal("CB4", 100 * hour);
  arrive(1 * hour);
  arrive(50 * hour);
  const std::vector<LateRange> late = archive.late_ranges("CB4");
  archive.forget_late(std::span(late).first(1));
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{50 * hour, 50 * hour + 1}));
  archive.forget_late(late);
  archive.forget_late(late);
  EXPECT_THAT(ranges(), IsEmpty());
}

TEST_F(LateTest, NeverForgetsWhatCameAfterTheMarksWereRead) {
  archive.seal("CB4", 100 * hour);
  arrive(1 * hour);
  const std::vector<LateRange> seen = archive.late_ranges("CB4");
  arrive(1 * hour + second);
  archive.forget_late(seen);
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{1 * hour, 1 * hour + second + 1}));
  archive.forget_late(archive.late_ranges("CB4"));
  arrive(2 * hour);
  archive.forget_late(seen);
  EXPECT_EQ(ranges().size(), 1U) << "an id is never used again";
}

TEST_F(LateTest, SurvivesTheExtremesOfTime) {
  constexpr Time least = std::numeric_limits<Time>::min(), most = std::numeric_limits<Time>::max();
  archive.seal("CB4", most);
  append({frame(1, least, {{1, Quality::good, 1}}), frame(2, most - 1, {{1, Quality::good, 2}})});
  arrive(least + 1);
  EXPECT_THAT(ranges(), ElementsAre(TimeRange{most - 1, most}, TimeRange{least, least + 2}));
}

TEST_F(LateTest, KeepsSealAndMarksInTheFile) {
  archive.seal("CB4", 10 * hour);
  arrive(1 * hour);
  database = Database(folder / "other.db", Database::Mode::read_write);
  database = Database(path, Database::Mode::read_write);
  arrive(5 * hour);
  EXPECT_EQ(ranges().size(), 2U);
}

}  // namespace
}  // namespace reident::storage::test::late_test
