#include "storage/archive/sequence.hpp"

#include <limits>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::sequence_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();

using Gap = std::pair<std::uint64_t, std::uint64_t>;  // first and last missing

class SequenceTest : public ArchiveTest {
 protected:
  /// A frame with a sample that was not there before.
  void fresh(std::uint64_t sequence) {
    append({frame(sequence, ++clock_, {{1, Quality::good, 1}})});
  }
  /// One frame a batch, and the state is read from the file each time.
  void fresh(const std::vector<std::uint64_t>& sequences) {
    for (const std::uint64_t sequence : sequences) fresh(sequence);
  }
  /// As the first, of a source whose run began with `first`.
  void fresh_of_run(std::uint64_t first, std::uint64_t sequence) {
    TelemetryFrame one = frame(sequence, ++clock_, {{1, Quality::good, 1}});
    one.first_sequence = first;
    late_starts_ = archive.append(std::vector{one}).late_starts;
  }
  void repeated(std::uint64_t sequence) {
    append({frame(sequence, clock_, {{1, Quality::good, 1}})});
  }
  std::vector<Gap> gaps() const {
    std::vector<Gap> gaps;
    for (const SequenceGap& gap : archive.sequence_gaps()) gaps.emplace_back(gap.first, gap.last);
    return gaps;
  }
  SourceCounts counts() const { return archive.sources().at(0); }

  std::vector<AppendReport::LateStart> late_starts_;  // of the last frame of a run

 private:
  Time clock_ = 0;
};

TEST(SequenceColumn, KeepsTheOrderOfAllNumbers) {
  const std::uint64_t ascending[] = {0, 1, most / 2, most / 2 + 1, most - 1, most};
  for (std::size_t i = 0; i < std::size(ascending); ++i) {
    EXPECT_EQ(from_column(to_column(ascending[i])), ascending[i]);
    if (i > 0) {
      EXPECT_LT(to_column(ascending[i - 1]), to_column(ascending[i]));
    }
  }
}

TEST_F(SequenceTest, SeesNoGapInFramesThatFollowEachOther) {
  fresh({5, 6, 7});
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_EQ(counts().missing, 0U);
  EXPECT_EQ(counts().out_of_order, 0U);
  EXPECT_EQ(counts().last_sequence, 7U);
}

TEST_F(SequenceTest, KeepsWhatIsMissingAsRanges) {
  fresh({1, 4, 5, 9});
  EXPECT_THAT(gaps(), ElementsAre(Gap(2, 3), Gap(6, 8)));
  EXPECT_EQ(counts().missing, 5U);
}

TEST_F(SequenceTest, TellsTheGenerationTimesOnEitherSideOfAGap) {
  append({frame(1, 100, {}), frame(9, 900, {})});
  append({frame(4, 400, {{1, Quality::good, 1}})});
  const std::vector<SequenceGap> found = archive.sequence_gaps();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].before, 100);
  EXPECT_EQ(found[0].after, 400);
  EXPECT_EQ(found[1].before, 400);
  EXPECT_EQ(found[1].after, 900);
}

TEST_F(SequenceTest, ShrinksSplitsAndClosesAGap) {
  fresh({1, 10});
  fresh(2);
  EXPECT_THAT(gaps(), ElementsAre(Gap(3, 9))) << "from below";
  fresh(9);
  EXPECT_THAT(gaps(), ElementsAre(Gap(3, 8))) << "from above";
  fresh(5);
  EXPECT_THAT(gaps(), ElementsAre(Gap(3, 4), Gap(6, 8))) << "in the middle";
  fresh({3, 4, 7, 6, 8});
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_EQ(counts().missing, 0U);
  EXPECT_EQ(counts().out_of_order, 8U);
  EXPECT_EQ(counts().restarts, 0U);
}

TEST_F(SequenceTest, TakesARepeatedFrameForNothingNew) {
  fresh({1, 2, 3});
  repeated(2);
  fresh(4);
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_EQ(counts().restarts, 0U);
  EXPECT_EQ(counts().out_of_order, 1U);
}

TEST_F(SequenceTest, CountsASourceThatBeginsAgainAsOneRestart) {
  fresh({998, 999, 1000, 0, 1, 2});
  EXPECT_EQ(counts().restarts, 1U);
  EXPECT_EQ(counts().missing, 0U);
  EXPECT_EQ(counts().last_sequence, 2U);
  EXPECT_EQ(counts().out_of_order, 1U);
}

TEST_F(SequenceTest, KeepsTheGapsOfARunAfterARestart) {
  fresh({100, 103, 1, 2, 5});
  EXPECT_THAT(gaps(), ElementsAre(Gap(101, 102), Gap(3, 4)));
  EXPECT_EQ(counts().missing, 4U);
  EXPECT_EQ(counts().restarts, 1U);
}

TEST_F(SequenceTest, ToleratesFramesReorderedAtTheStart) {
  fresh({12, 10, 11, 13});
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_EQ(counts().restarts, 0U);
}

TEST_F(SequenceTest, FollowsAPlaybackThatRunsBackwards) {
  fresh({100, 99, 98, 96});
  EXPECT_THAT(gaps(), ElementsAre(Gap(97, 97)));
  EXPECT_EQ(counts().restarts, 0U);
  EXPECT_EQ(counts().last_sequence, 100U);
}

TEST_F(SequenceTest, CountsWhatASourceSentBeforeItWasHeard) {
  fresh_of_run(1, 141);
  ASSERT_EQ(late_starts_.size(), 1U);
  EXPECT_EQ(late_starts_[0].came, 141U);
  EXPECT_EQ(late_starts_[0].first, 1U);
  EXPECT_THAT(gaps(), ElementsAre(Gap(1, 140)));
  fresh_of_run(1, 142);
  EXPECT_THAT(late_starts_, IsEmpty());
  fresh_of_run(1, 3);
  EXPECT_THAT(gaps(), ElementsAre(Gap(1, 2), Gap(4, 140))) << "it was late";
  EXPECT_EQ(counts().missing, 139U);
  EXPECT_EQ(counts().restarts, 0U);
}

TEST_F(SequenceTest, CountsNothingBeforeARunThatWasHeardFromItsBegin) {
  fresh_of_run(501, 501);
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_THAT(late_starts_, IsEmpty());
}

TEST_F(SequenceTest, DoesNotGuessWhereASourceBeganThatDoesNotSay) {
  fresh_of_run(0, 141);
  EXPECT_THAT(gaps(), IsEmpty());
  ASSERT_EQ(late_starts_.size(), 1U);
  EXPECT_EQ(late_starts_[0].first, 0U);
}

TEST_F(SequenceTest, CountsWhatIsMissingAtTheBeginOfASecondRun) {
  fresh_of_run(1, 1);
  fresh_of_run(1, 2);
  fresh_of_run(1, 3);
  fresh_of_run(1, 4);
  fresh_of_run(1, 3);
  EXPECT_EQ(counts().restarts, 1U);
  EXPECT_THAT(gaps(), ElementsAre(Gap(1, 2)));
}

TEST_F(SequenceTest, KeepsAnAbsurdJumpAsOneGapAndGoesOn) {
  const std::uint64_t absurd = std::uint64_t{1} << 63;
  fresh({1, 2, absurd, 3, 4, 5});
  EXPECT_THAT(gaps(), ElementsAre(Gap(6, absurd - 1)));
  EXPECT_EQ(counts().missing, absurd - 6);
  EXPECT_EQ(counts().last_sequence, absurd);
  EXPECT_EQ(counts().restarts, 0U);
}

TEST_F(SequenceTest, ReachesFromTheLeastNumberToTheGreatest) {
  fresh({0, most});
  EXPECT_THAT(gaps(), ElementsAre(Gap(1, most - 1)));
  EXPECT_EQ(counts().missing, most - 1);
  fresh(std::uint64_t{1} << 63);
  EXPECT_EQ(gaps().size(), 2U);
  EXPECT_EQ(counts().missing, most - 2);
  fresh(0);
  EXPECT_EQ(counts().restarts, 1U) << "the count wrapped around";
}

TEST_F(SequenceTest, CountsSourcesOriginsAndSpacecraftApart) {
  TelemetryFrame other = frame(500, 1, {});
  other.source = "station B";
  TelemetryFrame simulated = frame(70, 1, {});
  simulated.origin = Origin::simulated;
  append({frame(1, 1, {}), other, simulated, frame(2, 2, {})});
  other.sequence = 501;
  append({other});
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_EQ(archive.sources().size(), 3U);
}

TEST_F(SequenceTest, GivesTheSameStateForOneBatchAsForMany) {
  const std::vector<std::uint64_t> sequences{3, 1, 9, 5, 4, 700, 2, 20, 9};
  std::vector<TelemetryFrame> batch;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    batch.push_back(frame(sequences[i], static_cast<Time>(i + 1), {{1, Quality::good, 1}}));
    batch.back().source = "batched";
  }
  append(batch);
  for (TelemetryFrame& single : batch) {
    single.source = "single";
    single.samples[0].parameter = 2;
    append({single});
  }
  const std::vector<SourceCounts> sources = archive.sources();
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[0].missing, sources[1].missing);
  EXPECT_EQ(sources[0].out_of_order, sources[1].out_of_order);
  EXPECT_EQ(sources[0].restarts, sources[1].restarts);
  EXPECT_EQ(sources[0].last_sequence, sources[1].last_sequence);
  std::vector<Gap> batched, single;
  for (const SequenceGap& gap : archive.sequence_gaps())
    (gap.source == "batched" ? batched : single).emplace_back(gap.first, gap.last);
  EXPECT_EQ(batched, single);
}

}  // namespace
}  // namespace reident::storage::test::sequence_test
