#include "storage/care/retention.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include "storage/care/verify.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::retention_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Mode = Database::Mode;

constexpr Time second = 1'000'000'000;
constexpr Time latest = std::numeric_limits<Time>::max();
constexpr ArchiveOptions small_chunks{.chunk_samples = 64};

/// Samples at 1 Hz of parameters 1 and 2 of CB4, from second 0 to 1599: 25 chunks of each.
class RetentionTest : public ::testing::Test {
 protected:
  RetentionTest() {
    append(0, 1600);
    archive.compact();
  }
  void append(std::uint64_t from, std::uint64_t to, Origin origin = Origin::real,
              const std::string& spacecraft = "CB4") {
    std::vector<TelemetryFrame> frames;
    for (std::uint64_t k = from; k < to; ++k) {
      frames.push_back(frame(k, static_cast<Time>(k) * second,
                             {{1, Quality::good, static_cast<double>(k % 13)},
                              {2, Quality::good, static_cast<double>(k)}}));
      frames.back().origin = origin;
      frames.back().spacecraft = spacecraft;
    }
    archive.append(frames);
  }
  RetentionReport remove(const RetentionRule& rule,
                         const std::vector<ProtectedRange>& protection = {}, Time now = latest) {
    const RetentionReport plan = plan_retention(database, rule, protection, now);
    Retention retention(archive, rule, protection, now);
    while (retention.step()) {
    }
    if (!rule.max_bytes) {  // what is planned is an estimate where room counts
      EXPECT_EQ(plan.chunks, retention.report().chunks);
      EXPECT_EQ(plan.samples, retention.report().samples);
      EXPECT_EQ(plan.first, retention.report().first);
      EXPECT_EQ(plan.last, retention.report().last);
    }
    expect_sound();
    return retention.report();
  }
  void expect_sound() {
    const VerifyReport found = verify(database, {}, [](const auto&) { return true; });
    for (const Finding& finding : found.findings)
      ADD_FAILURE() << finding.check << " " << finding.name << ": " << finding.what;
  }
  std::vector<Time> seconds(std::uint32_t parameter, Origin origin = Origin::real) const {
    std::vector<Time> times = read_all(archive, parameter, origin).time;
    for (Time& time : times) time /= second;
    return times;
  }
  /// begin to end, in seconds.
  static std::vector<Time> from_to(Time begin, Time end) {
    std::vector<Time> times;
    for (Time t = begin; t < end; ++t) times.push_back(t);
    return times;
  }

  TemporaryFolder folder;
  fs::path path = folder / "a.db";
  Database database{path, Mode::read_write};
  Archive archive{database, small_chunks};
};

TEST_F(RetentionTest, KeepsEverythingWithoutARule) {
  EXPECT_EQ(remove({}).chunks, 0U);
  EXPECT_EQ(archive.sample_count(), 3200U);
}

TEST_F(RetentionTest, RemovesWholeChunksThatAreOlderThanTheNewestSampleByMoreThanTheRule) {
  const RetentionReport report = remove({.keep = 1000 * second});
  // The newest is 1599: chunks that end before 599 go, the one from 576 to 639 stays.
  EXPECT_EQ(report.chunks, 18U);
  EXPECT_EQ(report.samples, 2U * 576);
  EXPECT_EQ(report.first, 0);
  EXPECT_EQ(report.last, 575 * second);
  for (const std::uint32_t parameter : {1U, 2U}) EXPECT_EQ(seconds(parameter), from_to(576, 1600));
  EXPECT_EQ(archive.sample_count(), 2U * 1024);
  EXPECT_EQ(archive.extent("CB4", Origin::real), (TimeRange{576 * second, 1599 * second + 1}));
}

TEST_F(RetentionTest, CountsAgeFromTheClockWhereASampleRanAheadOfIt) {
  archive.append(std::vector{frame(9000, 4'000'000'000 * second, {{1, Quality::good, 1}})});
  archive.compact();
  EXPECT_EQ(remove({.keep = 1000 * second}, {}, 1599 * second).chunks, 18U);
}

TEST_F(RetentionTest, KeepsWhatNothingNewerFollows) {
  append(0, 640, Origin::real, "OLD");
  archive.compact();
  EXPECT_EQ(remove({.keep = 1000 * second}, {}, latest).chunks, 18U);
  EXPECT_EQ(archive.extent("OLD", Origin::real), (TimeRange{0, 639 * second + 1}));
}

TEST_F(RetentionTest, WorksInBoundedSteps) {
  append(1600, 1600 + 64 * 300);
  archive.compact();
  const std::uint64_t before = archive.sample_count();
  Retention retention(archive, {.keep = 64 * second}, {}, latest);
  EXPECT_TRUE(retention.step());
  EXPECT_EQ(retention.report().chunks, Retention::chunks_of_step);
  EXPECT_EQ(archive.sample_count(), before - retention.report().samples);
  expect_sound();
  append(30000, 30010);  // others write between two steps
  while (retention.step()) {
  }
  EXPECT_GT(retention.report().chunks, 600U);
  expect_sound();
}

TEST_F(RetentionTest, NeverTakesAChunkThatHoldsProtectedTime) {
  append(0, 1600, Origin::simulated);
  archive.compact();
  const std::vector<ProtectedRange> protection{
      {"CB4", 1, {100 * second, 130 * second}},  // chunks from 64 and from 128
      {"CB4", 1, {255 * second, 256 * second}},  // the last sample of the chunk from 192
      {"CB4", 2, {64 * second, 64 * second}},    // nothing
      {"OTHER", std::nullopt, {0, latest}}};
  const RetentionReport report = remove({.keep = 1000 * second}, protection);
  EXPECT_EQ(report.protected_chunks, 2U * 3);
  std::vector<Time> left = from_to(64, 256);
  const std::vector<Time> young = from_to(576, 1600);
  left.insert(left.end(), young.begin(), young.end());
  for (const Origin origin : {Origin::real, Origin::simulated}) {
    EXPECT_EQ(seconds(1, origin), left);
    EXPECT_EQ(seconds(2, origin), young);
  }
  EXPECT_EQ(remove({.keep = 1000 * second}, protection).chunks, 0U);
  EXPECT_EQ(remove({.keep = 1000 * second}).chunks, 6U) << "once it is not protected any more";
}

TEST_F(RetentionTest, ProtectsEveryParameterWhereItIsNotKnownWhich) {
  EXPECT_EQ(remove({.keep = 64 * second}, {{"CB4", std::nullopt, {0, 1536 * second}}}).chunks, 0U);
}

TEST_F(RetentionTest, RemovesTheOldestUntilThereIsRoomEnough) {
  append(0, 9600, Origin::real, "BIG");
  archive.compact();
  const std::uint64_t in_use = plan_retention(database, {}, {}, latest).bytes_in_use;
  const std::uint64_t limit = in_use - 60'000;
  const RetentionReport plan = plan_retention(database, {.max_bytes = limit}, {}, latest);
  const RetentionReport report = remove({.max_bytes = limit});
  EXPECT_LE(report.bytes_in_use, limit);
  EXPECT_GT(report.bytes_in_use, limit - 40'000);
  EXPECT_FALSE(report.too_large);
  EXPECT_GT(report.chunks, 0U);
  EXPECT_GT(plan.chunks, 0U);
  // The oldest of all series went: those that are left begin together.
  const Time first = archive.extent("BIG", Origin::real)->begin;
  EXPECT_LE(
      std::abs(first - archive.extent("CB4", Origin::real).value_or(TimeRange{first, 0}).begin),
      64 * second);
  EXPECT_EQ(remove({.max_bytes = limit}).chunks, 0U);
}

TEST_F(RetentionTest, SaysWhenWhatIsProtectedIsTooLarge) {
  const RetentionReport report = remove({.max_bytes = 4096}, {{"CB4", std::nullopt, {0, latest}}});
  EXPECT_TRUE(report.too_large);
  EXPECT_EQ(report.chunks, 0U);
  EXPECT_EQ(report.protected_chunks, 50U);
}

TEST_F(RetentionTest, UsesFreedPagesAgain) {
  remove({.keep = 64 * second});
  database = Database(folder / "other.db", Mode::read_write);  // folds the log
  const auto size = fs::file_size(path);
  database = Database(path, Mode::read_write);
  append(1600, 2600);
  archive.compact();
  database = Database(folder / "other.db", Mode::read_write);
  EXPECT_EQ(fs::file_size(path), size);
}

TEST_F(RetentionTest, KeepsAccountOfWhatItRemovedInFewRows) {
  const std::string sql =
      "SELECT spacecraft, parameter, origin, begin_time / 1000000000, end_time / 1000000000, "
      "samples, cause, time FROM telemetry_removed ORDER BY parameter, begin_time";
  remove({.keep = 1200 * second}, {}, 2000 * second);
  remove({.keep = 1000 * second}, {}, 3000 * second);
  EXPECT_THAT(rows(path, sql), ElementsAre("CB4|1|real|0|575|576|age|3000000000000",
                                           "CB4|2|real|0|575|576|age|3000000000000"));
}

TEST_F(RetentionTest, KeepsAccountOfRangesApartThatSomethingIsLeftBetween) {
  remove({.keep = 1000 * second}, {{"CB4", 1, {100 * second, 120 * second}}}, 2000 * second);
  EXPECT_THAT(rows(path,
                   "SELECT begin_time / 1000000000, end_time / 1000000000, samples "
                   "FROM telemetry_removed WHERE parameter = '1' ORDER BY 1"),
              ElementsAre("0|63|64", "128|575|448"));
}

TEST_F(RetentionTest, ArchivesLateSamplesOfRemovedTimeAndRemovesThemNextTime) {
  remove({.keep = 1000 * second});
  append(100, 164);
  EXPECT_EQ(seconds(1).front(), 100);
  EXPECT_EQ(archive.sources().at(0).late, 128U);
  EXPECT_EQ(plan_retention(database, {.keep = 1000 * second}, {}, latest).chunks, 0U)
      << "they are not in chunks yet";
  archive.compact();
  EXPECT_EQ(remove({.keep = 1000 * second}).samples, 128U);
  EXPECT_EQ(seconds(1), from_to(576, 1600));
  EXPECT_THAT(rows(path, "SELECT samples FROM telemetry_removed"), ElementsAre("640", "640"));
}

TEST_F(RetentionTest, LeavesAChunkThatWaitsForLateSamples) {
  std::vector<TelemetryFrame> late;
  for (std::uint64_t k = 70; k < 80; ++k)
    late.push_back(frame(k, static_cast<Time>(k) * second + 5, {{1, Quality::good, 7}}));
  archive.append(late);
  Retention retention(archive, {.keep = 1000 * second}, {}, latest);
  while (retention.step()) {
  }
  EXPECT_EQ(retention.report().chunks, 17U);
  expect_sound();
  archive.compact();
  EXPECT_GE(remove({.keep = 1000 * second}).chunks, 1U);
  EXPECT_EQ(seconds(1), from_to(576, 1600));
}

TEST_F(RetentionTest, LeavesAnEmptySeriesWhereAllIsOld) {
  append(100'000, 100'010, Origin::real);
  EXPECT_EQ(remove({.keep = 1000 * second}).samples, 3200U);
  EXPECT_EQ(seconds(1), from_to(100'000, 100'010));
  Database other(folder / "b.db", Mode::read_write);
}

TEST_F(RetentionTest, HoldsEveryInvariantWhileTelemetryComesInAnyOrder) {
  std::mt19937 random(20170717);
  std::uint64_t newest = 1600;
  for (int round = 0; round < 30; ++round) {
    const std::uint64_t from = random() % 3 ? newest : random() % newest;
    append(from, from + 20 + random() % 200);
    newest = std::max(newest, from + 220);
    const Time keep = static_cast<Time>(200 + random() % 2000) * second;
    const Time begin = static_cast<Time>(random() % newest) * second;
    Retention retention(archive, {.keep = keep}, {{"CB4", 1, {begin, begin + 100 * second}}},
                        latest);
    const std::vector<Time> before = seconds(1);
    while (retention.step()) {
    }
    const std::vector<Time> after = seconds(1);
    for (const Time t : before) {
      const bool is_protected = t >= begin / second && t < begin / second + 100;
      EXPECT_TRUE(!is_protected || std::binary_search(after.begin(), after.end(), t)) << t;
    }
    expect_sound();
    if (HasFailure()) return;
  }
  EXPECT_GT(rows(path, "SELECT 1 FROM removal").size(), 1U);
}

}  // namespace
}  // namespace reident::storage::test::retention_test
