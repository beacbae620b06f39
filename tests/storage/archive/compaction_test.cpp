// Fragments become chunks in bounded steps, and nothing changes for a reader.
#include <limits>

#include "storage/database/connection.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::compaction_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr Time second = 1'000'000'000;

class CompactionTest : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder / "a.db";
  std::optional<Database> database;
  std::optional<Archive> archive;
  std::uint64_t sequence = 0;

  void open(const ArchiveOptions& options) {
    archive.reset();
    database.reset();
    database.emplace(path, Database::Mode::read_write);
    archive.emplace(*database, options);
  }
  /// Parameter 1, one sample a second in [begin, end).
  AppendReport append(Time begin, Time end, double value = 1) {
    std::vector<TelemetryFrame> frames;
    for (Time t = begin; t < end; ++t)
      frames.push_back(frame(sequence++, t * second, {{1, Quality::good, value}}));
    return archive->append(frames);
  }
  std::vector<std::string> ask(const std::string& sql) const { return rows(path, sql); }
  std::size_t count() const { return read_all(*archive, 1).time.size(); }
};

TEST_F(CompactionTest, ChunksFilledInOrderOfTimeAreFullButForTheLast) {
  open({.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000});
  for (Time t = 0; t < 1000; t += 10) append(t, t + 10);
  archive->compact();
  EXPECT_LE(std::stoi(ask("SELECT count(*) FROM chunk").at(0)), 12);
  EXPECT_GE(std::stoi(ask("SELECT count(*) FROM chunk WHERE samples = 100").at(0)), 8);
  EXPECT_THAT(ask("SELECT count(*) FROM recent"), ElementsAre("0"));
  EXPECT_EQ(count(), 1000U);
}

TEST_F(CompactionTest, LivesWithFewSmallChunksAtTheEnd) {
  open({.chunk_samples = 4096, .recent_samples = 1000, .recent_batches = 8});
  for (Time t = 0; t < 3000; ++t) append(t, t + 1);
  archive->compact();
  EXPECT_LE(std::stoi(ask("SELECT count(*) FROM chunk").at(0)), 10);
  EXPECT_EQ(count(), 3000U);
}

TEST_F(CompactionTest, PlaybackBackwardsGivesFullChunksToo) {
  open({.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000});
  for (Time t = 1000; t > 0; t -= 10) append(t - 10, t);
  archive->compact();
  EXPECT_LE(std::stoi(ask("SELECT count(*) FROM chunk").at(0)), 20);
  EXPECT_EQ(count(), 1000U);
}

TEST_F(CompactionTest, ALateSampleLandsInItsChunk) {
  open({.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000});
  append(0, 50);
  append(51, 500);
  archive->compact();
  EXPECT_EQ(append(50, 51, 7).late, 1U);
  archive->compact();
  EXPECT_THAT(archive->read("CB4", Origin::real, 1, {50 * second, 51 * second}).value,
              ElementsAre(7));
  EXPECT_THAT(ask("SELECT count(*) FROM chunk WHERE first_time <= 50000000000 AND "
                  "last_time >= 50000000000"),
              ElementsAre("1"));
  EXPECT_EQ(append(50, 51, 7).duplicates, 1U);
  EXPECT_EQ(append(50, 51, 8).conflicts, 1U);
  EXPECT_EQ(count(), 500U);
}

TEST_F(CompactionTest, RemembersSampleGapsUntilTheyClose) {
  open({.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000});
  append(0, 90);
  append(95, 300);
  archive->compact();
  const char* gaps = "SELECT begin_time / 1000000000, end_time / 1000000000 FROM sample_gap";
  EXPECT_THAT(ask(gaps), ElementsAre("89|95"));
  append(91, 93);
  archive->compact();
  EXPECT_THAT(ask(gaps), ElementsAre("89|91", "92|95"));
  append(90, 91);
  append(93, 95);
  archive->compact();
  EXPECT_THAT(ask(gaps), IsEmpty());
}

TEST_F(CompactionTest, StopsAnywhereAndGoesOnWithNothingLostOrDoubled) {
  const ArchiveOptions options{.chunk_samples = 16, .recent_samples = 40, .recent_batches = 1000};
  open(options);
  for (Time t = 0; t < 2000; t += 7) {
    append(t, t + 7);
    if (t % 3 == 0) append(std::max<Time>(0, t - 60), t - 50, 2);
    if (t % 5 == 0) open(options);
  }
  const std::size_t before = count();
  archive->compact();
  EXPECT_EQ(count(), before);
  EXPECT_EQ(archive->sample_count(), before);
}

TEST_F(CompactionTest, BoundsWhatIsRecent) {
  open({.chunk_samples = 100, .recent_samples = 500, .recent_batches = 10});
  for (Time t = 0; t < 20000; t += 100) {
    append(t, t + 100);
    ASSERT_LE(std::stoi(ask("SELECT total(samples) FROM recent").at(0)), 2500);
    ASSERT_LE(std::stoi(ask("SELECT count(DISTINCT batch) FROM recent").at(0)), 25);
  }
}

TEST_F(CompactionTest, TakesManySamplesOfOneParameterInOneAppend) {
  open({});
  append(0, 300'000);
  EXPECT_EQ(count(), 300'000U);
  archive->compact();
  EXPECT_EQ(count(), 300'000U);
}

TEST_F(CompactionTest, SetsAsideAChunkThatItCannotReadAndSaysSo) {
  const ArchiveOptions options{.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000};
  open(options);
  append(0, 300);
  archive->compact();
  archive.reset();
  database.reset();
  ask("UPDATE chunk_data SET bytes = zeroblob(length(bytes)) WHERE id = "
      "(SELECT data FROM chunk WHERE first_time = 100000000000)");
  open(options);
  EXPECT_THAT(error_of([&] { count(); }),
              HasSubstr("100 samples of 1 of CB4 from 1970-01-01T00:01:40.000000000Z to "
                        "1970-01-01T00:03:19.000000000Z cannot be read"));
  const AppendReport report = append(150, 160, 9);
  EXPECT_EQ(report.stored, 10U) << "nobody can say that they were known";
  EXPECT_THAT(report.damages, ElementsAre(HasSubstr("cannot be read")));
  archive->compact();
  EXPECT_EQ(count(), 210U);
  EXPECT_THAT(ask("SELECT first_time, samples FROM damaged_chunk"),
              ElementsAre("100000000000|100"));
}

TEST_F(CompactionTest, TakesNothingFromAChunkThatItsRowDoesNotDescribe) {
  const ArchiveOptions options{.chunk_samples = 100, .recent_samples = 30, .recent_batches = 1000};
  open(options);
  append(0, 90);
  archive->compact();
  archive.reset();
  database.reset();
  ask("UPDATE chunk SET last_time = 60000000000");
  open(options);
  append(50, 75, 9);
  archive->compact();
  EXPECT_EQ(count(), 25U);
  EXPECT_THAT(ask("SELECT samples, reason FROM damaged_chunk"),
              ElementsAre("90|holds other samples than its row says"));
}

TEST_F(CompactionTest, SetsAsideAFragmentThatItCannotRead) {
  open({});
  append(0, 10);
  append(10, 20);
  archive.reset();
  database.reset();
  ask("UPDATE recent SET data = zeroblob(length(data)) WHERE batch = 1");
  open({});
  EXPECT_THAT(error_of([&] { count(); }), HasSubstr("10 samples of 1 of CB4"));
  EXPECT_THAT(append(20, 30).damages, SizeIs(1));
  EXPECT_EQ(count(), 20U);
}

}  // namespace
}  // namespace reident::storage::test::compaction_test
