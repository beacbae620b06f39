// What survives a full disk and a cut log, tested by doing it. kill_test and power_cut_test have
// the rest.
#include <atomic>
#include <csignal>
#include <random>
#include <thread>

#include <sys/resource.h>

#include "storage/database/connection.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::durability_test {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;
using Mode = Database::Mode;

constexpr std::uint64_t frames_of_batch = 10;
constexpr std::uint32_t parameters = 20;
constexpr std::uint64_t samples_of_batch = frames_of_batch * parameters;

double value_at(std::uint32_t parameter, Time time) {
  return static_cast<double>(time) * 0.1 + static_cast<double>(parameter);
}

/// Everything about a batch follows from its number.
std::vector<TelemetryFrame> batch(std::uint64_t number) {
  std::vector<TelemetryFrame> frames;
  for (std::uint64_t i = 0; i < frames_of_batch; ++i) {
    const std::uint64_t sequence = number * frames_of_batch + i;
    frames.push_back(frame(sequence, static_cast<Time>(sequence), {}));
    for (std::uint32_t p = 0; p < parameters; ++p)
      frames.back().samples.push_back(
          {p, Quality::good, value_at(p, frames.back().generation_time)});
  }
  return frames;
}

/// Number of whole batches in the archive; fails the test where one is in part or wrong.
std::uint64_t whole_batches(const Archive& archive) {
  const std::uint64_t count = archive.sample_count();
  EXPECT_EQ(count % samples_of_batch, 0U) << "half a batch";
  const std::uint64_t batches = count / samples_of_batch;
  for (std::uint32_t p = 0; p < parameters; ++p) {
    const Series series = read_all(archive, p);
    EXPECT_EQ(series.time.size(), batches * frames_of_batch);
    for (std::size_t i = 0; i < series.time.size(); ++i)
      if (series.time[i] != static_cast<Time>(i) ||
          series.value[i] != value_at(p, series.time[i])) {
        ADD_FAILURE() << "sample " << i << " of parameter " << p << " is not what was stored";
        return batches;
      }
  }
  if (batches > 0) {
    const SourceCounts source = archive.sources().at(0);
    EXPECT_EQ(source.frames, batches * frames_of_batch);
    EXPECT_EQ(source.samples, count);
    EXPECT_EQ(source.last_sequence, batches * frames_of_batch - 1);
    EXPECT_EQ(source.missing, 0U);
  }
  return batches;
}

TEST(Durability, ALogThatIsCutAnywhereLeavesWholeBatches) {
  const TemporaryFolder folder(fs::temp_directory_path());
  Database database(folder / "a.db", Mode::read_write);
  Archive archive(database);
  for (std::uint64_t number = 0; number < 6; ++number) archive.append(batch(number));
  const std::string file = read_file(folder / "a.db"), log = read_file(folder / "a.db-wal");
  std::mt19937 random(7);
  std::uint64_t most = 0;
  for (int i = 0; i < 25; ++i) {
    const std::size_t length = i == 0 ? log.size() : random() % log.size();
    write_file(folder / "cut.db", file);
    write_file(folder / "cut.db-wal", log.substr(0, length));
    fs::remove(folder / "cut.db-shm");
    const std::string opened = error_of([&] {
      Database cut(folder / "cut.db", Mode::read_write);
      most = std::max(most, whole_batches(Archive(cut)));
    });
    EXPECT_EQ(opened, "no error") << "log cut at " << length << " of " << log.size();
  }
  EXPECT_EQ(most, 6U);
}

TEST(Durability, ACommitWaitsForTheDiskUnlessToldOtherwise) {
  const TemporaryFolder folder;
  const auto synchronous = [&](Durability durability) {
    const Database database(folder / "a.db", Mode::read_write, durability);
    sqlite::Query row = database.impl().connection->query("PRAGMA synchronous");
    return row.step() ? row.integer(0) : -1;
  };
  EXPECT_EQ(synchronous(Durability::power_cut), 2) << "FULL: each commit flushes the log";
  EXPECT_EQ(synchronous(Durability::kill), 1) << "NORMAL: folding it into the file does";
}

void limit_files_to(rlim_t bytes) {
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  limit.rlim_cur = bytes;
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

TEST(Durability, AFullDiskLosesNothingStoredAndAppendsGoOnWhenThereIsRoom) {
  const TemporaryFolder folder(fs::temp_directory_path());
  const fs::path path = folder / "a.db";
  const std::string outcome = in_child([&]() -> std::string {
    Database database(path, Mode::read_write);
    Archive archive(database);
    std::uint64_t next = 0;
    archive.append(batch(next++));
    for (int shortage = 0; shortage < 3; ++shortage) {
      limit_files_to(fs::file_size(path.string() + "-wal") + 150'000);
      std::string error = "no error";
      while (error == "no error" && next < 1000)
        if (error = error_of([&] { archive.append(batch(next)); }); error == "no error") ++next;
      if (!error.starts_with("full: database " + path.string() + " has no room"))
        return "shortage gave: " + error;
      if (archive.sample_count() != next * samples_of_batch) return "a full disk lost something";
      if (!error_of([&] { archive.append(batch(next)); }).starts_with("full: "))
        return "a second try did not say that the disk is full";
      limit_files_to(RLIM_INFINITY);
      for (int i = 0; i < 3; ++i) archive.append(batch(next++));
      if (archive.sample_count() != next * samples_of_batch) return "appends did not go on";
    }
    return "stored " + std::to_string(next);
  });
  ASSERT_THAT(outcome, StartsWith("stored "));
  Database database(path, Mode::read_only);
  EXPECT_EQ("stored " + std::to_string(whole_batches(Archive(database))), outcome);
}

TEST(Durability, AFileThatHadNoRoomForItsTablesIsMadeWhenThereIs) {
  const TemporaryFolder folder(fs::temp_directory_path());
  const std::string outcome = in_child([&]() -> std::string {
    for (const rlim_t bytes : {100U, 4096U, 20000U, 50000U}) {
      limit_files_to(bytes);
      const std::string error =
          error_of([&] { const Database database(folder / "a.db", Mode::read_write); });
      if (!error.starts_with("full: ")) return std::to_string(bytes) + " bytes: " + error;
    }
    limit_files_to(RLIM_INFINITY);
    Database database(folder / "a.db", Mode::read_write);
    return std::to_string(Archive(database).append(batch(0)).stored);
  });
  EXPECT_EQ(outcome, std::to_string(samples_of_batch));
}

TEST(Durability, AReaderSeesWholeBatchesWhileTheWriterAppends) {
  const TemporaryFolder folder(fs::temp_directory_path());
  const fs::path path = folder / "a.db";
  Database database(path, Mode::read_write);
  Archive archive(database);
  archive.append(batch(0));
  std::atomic<bool> done = false;
  std::uint64_t looks = 0, last = 0;
  bool whole = true, forward = true;
  std::thread reader([&] {
    Database own(path, Mode::read_only);
    const Archive view(own);
    do {
      const std::uint64_t count = view.sample_count();
      whole = whole && count % samples_of_batch == 0;
      forward = forward && count >= last;
      const std::size_t rows_of_one = read_all(view, 3).time.size();
      whole = whole && rows_of_one % frames_of_batch == 0;
      forward = forward && rows_of_one * parameters >= count;
      last = count;
      ++looks;
    } while (!done);
  });
  for (std::uint64_t number = 1; number < 60; ++number) archive.append(batch(number));
  done = true;
  reader.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(forward);
  EXPECT_GT(looks, 1U);
  EXPECT_EQ(whole_batches(archive), 60U);
}

TEST(Durability, ABatchThatFailsHalfWayLeavesNothing) {
  const TemporaryFolder folder(fs::temp_directory_path());
  Database database(folder / "a.db", Mode::read_write);
  Archive archive(database);
  archive.append(batch(0));
  rows(folder / "a.db",
       "CREATE TRIGGER refuse BEFORE UPDATE ON source BEGIN SELECT RAISE(ABORT, 'no'); END");
  EXPECT_THAT(error_of([&] { archive.append(batch(1)); }), StartsWith("failed: "));
  rows(folder / "a.db", "DROP TRIGGER refuse");
  EXPECT_EQ(whole_batches(archive), 1U);
  archive.append(batch(1));
  EXPECT_EQ(whole_batches(archive), 2U);
}

}  // namespace
}  // namespace reident::storage::test::durability_test
