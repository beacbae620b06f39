#include "storage/care/split.hpp"

#include <bit>
#include <cmath>
#include <csignal>
#include <limits>
#include <unistd.h>

#include <sys/wait.h>

#include "storage/archive/holdings.hpp"
#include "storage/care/backup.hpp"
#include "storage/care/completeness.hpp"
#include "storage/care/retention.hpp"
#include "storage/care/verify.hpp"
#include "tests/storage/database/watched_files.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::split_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Mode = Database::Mode;

constexpr Time hour = 3'600'000'000'000;
constexpr Time day = 24 * hour;
constexpr Time begin_2023 = 19'358 * day;
constexpr Time begin_2024 = begin_2023 + 365 * day;
constexpr Time begin_2025 = begin_2024 + 366 * day;
constexpr Time latest = std::numeric_limits<Time>::max();
constexpr ArchiveOptions small_chunks{.chunk_samples = 64};
constexpr std::uint32_t parameters = 2;

bool to_the_end(const SplitProgress&) {
  return true;
}

/// Two parameters each six hours of three years, with a hole over the first new year.
class Split : public ::testing::Test {
 protected:
  Split() {
    append(begin_2023, begin_2024 - 3 * day);
    append(begin_2024 + 2 * day, begin_2025 + 100 * day);
    archive.compact();
  }
  std::uint64_t append(Time begin, Time end, double offset = 0) {
    std::vector<TelemetryFrame> frames;
    for (Time time = begin; time < end; time += 6 * hour) {
      const double value = std::sin(static_cast<double>(time / hour)) + offset;
      frames.push_back(
          frame(++sequence_, time, {{1, Quality::good, value}, {2, Quality::suspect, -value}}));
    }
    return archive.append(frames).stored;
  }
  SplitReport split(std::int64_t before = 2025) {
    return split_by_year(archive, before, to_the_end);
  }
  /// All that a reader can ask for, in words.
  static std::vector<std::string> contents(const fs::path& path) {
    std::vector<std::string> texts;
    Database opened(path, Mode::read_only);
    const Archive reader(opened);
    const auto add = [&](const Series& series) {
      std::string text = std::to_string(series.time.size());
      for (std::size_t i = 0; i < series.time.size(); ++i)
        text += " " + std::to_string(series.time[i]) + " " +
                std::to_string(std::bit_cast<std::uint64_t>(series.value[i])) + " " +
                std::to_string(static_cast<int>(series.quality[i])) + " " +
                std::to_string(series.source[i]);
      texts.push_back(std::move(text));
    };
    for (std::uint32_t p = 1; p <= parameters; ++p) {
      add(reader.read_with_sources("CB4", Origin::real, p, {0, latest}));
      add(reader.read_with_sources("CB4", Origin::real, p,
                                   {begin_2024 - 20 * day, begin_2024 + 20 * day}));
      for (const Time time : {begin_2024 - 1, begin_2024 - 40 * day + 1, begin_2025})
        texts.push_back(std::to_string(*reader.first_at_or_after("CB4", Origin::real, p, time)) +
                        " " +
                        std::to_string(*reader.last_at_or_before("CB4", Origin::real, p, time)));
    }
    for (const SeriesInfo& series : all_series(opened))
      for (const BinCounts& month :
           completeness(opened, series, TimeBins({begin_2023, begin_2025}, 30 * day), series.last))
        texts.push_back(std::to_string(month.came) + " " + std::to_string(month.missing) + " " +
                        std::to_string(month.gaps));
    for (const std::string& row : rows(path,
                                       "SELECT * FROM telemetry_series; "
                                       "SELECT * FROM telemetry_hole"))
      texts.push_back(row);
    return texts;
  }
  static std::vector<std::string> findings(const fs::path& path) {
    Database opened(path, Mode::read_only);
    std::vector<std::string> texts;
    for (const Finding& finding : verify(opened, {}, [](const auto&) { return true; }).findings)
      texts.push_back(finding.check + ": " + finding.what);
    return texts;
  }
  fs::path shard(const SplitReport& report, std::size_t i) const {
    return folder / "a.db.shards" / report.made.at(i).file;
  }
  std::uint64_t chunks_of_shards() const {
    return std::stoull(rows(path, "SELECT count(*) FROM chunk WHERE shard <> 0").at(0));
  }

  TemporaryFolder folder;
  fs::path path = folder / "a.db";
  Database database{path, Mode::read_write};
  Archive archive{database, small_chunks};
  std::uint64_t sequence_ = 0;
};

TEST_F(Split, ReadsTheSameBitsFromShardsAsFromTheDatabase) {
  const auto before = contents(path);
  const SplitReport report = split();
  ASSERT_THAT(report.made, SizeIs(2));
  EXPECT_TRUE(report.complete);
  EXPECT_THAT(report.made[0].file, StartsWith("2023-"));
  EXPECT_THAT(report.made[1].file, StartsWith("2024-"));
  EXPECT_EQ(report.chunks, report.made[0].chunks + report.made[1].chunks);
  EXPECT_EQ(contents(path), before);
  EXPECT_THAT(findings(path), IsEmpty());
  EXPECT_THAT(rows(path,
                   "SELECT count(*) FROM chunk_data WHERE id NOT IN (SELECT data FROM chunk "
                   "WHERE shard = 0); SELECT sum(chunks) FROM shard"),
              ElementsAre("0", std::to_string(report.chunks)));
  EXPECT_EQ(split().chunks, 0U) << "nothing is left to split";
  EXPECT_NE(rows(path, "PRAGMA freelist_count"), std::vector<std::string>{"0"});
  give_back_room(database);
  EXPECT_THAT(rows(path, "PRAGMA freelist_count"), ElementsAre("0"));
  EXPECT_EQ(contents(path), before);
  EXPECT_EQ(append(begin_2025 + 200 * day, begin_2025 + 201 * day), 8U);
}

TEST_F(Split, AShardIsAnArchiveByItself) {
  const SplitReport report = split();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_THAT(findings(shard(report, i)), IsEmpty());
    Database opened(shard(report, i), Mode::read_only);
    EXPECT_EQ(Archive(opened).sample_count(), report.made[i].samples);
  }
}

TEST_F(Split, AShardIsNoDatabaseThatCanBeWritten) {
  const SplitReport report = split();
  const auto before = contents(path);
  EXPECT_THROW(Database(shard(report, 0), Mode::read_write), Error);
  EXPECT_THROW(Database(shard(report, 0), Mode::update), Error);
  EXPECT_EQ(contents(path), before);
}

TEST_F(Split, LateSamplesOfAClosedYearAreReadWithItAndSplitAgain) {
  split();
  const std::uint64_t in_shards = chunks_of_shards();
  EXPECT_EQ(append(begin_2023 + 100 * day + hour, begin_2023 + 101 * day), 8U);
  EXPECT_EQ(append(begin_2023 + 100 * day, begin_2023 + 101 * day), 0U) << "known from the shard";
  archive.compact();
  EXPECT_EQ(chunks_of_shards(), in_shards - parameters);
  const auto before = contents(path);
  EXPECT_THAT(findings(path), IsEmpty());
  EXPECT_EQ(archive.read("CB4", Origin::real, 1, {begin_2023 + 100 * day, begin_2023 + 101 * day})
                .time.size(),
            8U);
  const SplitReport again = split();
  ASSERT_THAT(again.made, SizeIs(1));
  EXPECT_EQ(again.chunks, parameters);
  EXPECT_EQ(contents(path), before);
  EXPECT_THAT(findings(path), IsEmpty());
  EXPECT_THAT(findings(shard(again, 0)), IsEmpty());
}

TEST_F(Split, AMissingShardIsNamedAndIngestGoesOn) {
  const auto before = contents(path);
  const SplitReport report = split();
  const fs::path file = shard(report, 0), away = folder / "away.db";
  const auto read = [&](Time begin, Time end) {
    return error_of([&] {
      Database opened(path, Mode::read_only);
      Archive(opened).read("CB4", Origin::real, 1, {begin, end});
    });
  };
  fs::rename(file, away);
  EXPECT_THAT(read(begin_2023, begin_2023 + day),
              AllOf(StartsWith("cannot_open: "), HasSubstr(file.string()), HasSubstr("missing")));
  EXPECT_EQ(read(begin_2024 + 30 * day, latest), "no error");
  EXPECT_THAT(findings(path), ElementsAre(HasSubstr(file.string())));
  EXPECT_EQ(append(begin_2025 + 200 * day, begin_2025 + 201 * day), 8U);
  archive.compact();
  fs::copy(shard(report, 1), file);
  EXPECT_THAT(read(begin_2023, begin_2023 + day), HasSubstr("another file"));
  write_file(file, "no archive");
  EXPECT_THAT(read(begin_2023, begin_2023 + day), HasSubstr("cannot be read"));
  fs::rename(away, file);
  EXPECT_THAT(findings(path), IsEmpty());
  EXPECT_EQ(contents(path).at(1), before.at(1));
}

/// One of the shards is lost after a copy of all was made.
class LostShard : public Split {
 protected:
  fs::path copied(const char* name) {
    back_up(database, folder / name, {}, [](const auto&) { return true; });
    return folder / name;
  }
  /// Two days of a closed year, of which a part came already, and a day of now.
  static AppendReport append_late(Archive& to, Time late = begin_2023 + 100 * day) {
    std::vector<TelemetryFrame> frames;
    std::uint64_t sequence = 5000;
    const auto add = [&](Time time, double value) {
      frames.push_back(
          frame(++sequence, time, {{1, Quality::good, value}, {2, Quality::suspect, value}}));
    };
    for (Time time = late; time < late + 2 * day; time += hour) add(time, 0.5);
    add(late + hour, std::nan(""));
    for (Time time = begin_2025 + 200 * day; time < begin_2025 + 201 * day; time += hour)
      add(time, 0.25);
    return to.append(frames);
  }
  void put_back() const {
    fs::copy_file(fs::path(whole_.string() + ".shards") / file_.filename(), file_,
                  fs::copy_options::overwrite_existing);
  }

  const fs::path file_ = shard(split(), 0), whole_ = copied("whole.db");
  Database whole_database_{whole_, Mode::read_write};
  Archive whole_archive_{whole_database_, small_chunks};
};

TEST_F(LostShard, LateSamplesWaitForItAndAllOthersAreStored) {
  fs::remove(file_);
  const AppendReport report = append_late(archive);
  EXPECT_EQ(report.stored, 24U * parameters) << "those of now";
  EXPECT_THAT(report.postponed, AllOf(HasSubstr(file_.string()), HasSubstr("put the folder")));
  EXPECT_THAT(report.damages, IsEmpty());
  archive.compact();
  EXPECT_THAT(findings(path), ElementsAre(HasSubstr(file_.string())));
  put_back();
  archive.compact();
  append_late(whole_archive_);
  whole_archive_.compact();
  EXPECT_EQ(contents(path), contents(whole_));
  EXPECT_THAT(findings(path), IsEmpty());
  EXPECT_THAT(append_late(archive).postponed, IsEmpty());
}

TEST_F(LostShard, LateSamplesWaitThatWereComparedWithItBefore) {
  const fs::path third = copied("third.db");
  const auto with_third = [&](const std::function<void(Archive&)>& work) {
    Database opened(third, Mode::read_write);
    Archive there(opened, small_chunks);
    work(there);
  };
  with_third([](Archive& there) { append_late(there); });
  const fs::path shard = fs::path(third.string() + ".shards") / file_.filename();
  fs::remove(shard);
  with_third([](Archive& there) {
    for (int i = 0; i < 3; ++i) there.compact();
    append_late(there);
  });
  EXPECT_THAT(findings(third), ElementsAre(HasSubstr(shard.string())));
  EXPECT_THAT(rows(third, "SELECT max(settled), min(settled) FROM postponed_sample"),
              ElementsAre("1|0"));
  fs::copy(file_, shard);
  EXPECT_THAT(findings(third), IsEmpty()) << "what waits is counted";
  with_third([](Archive& there) { there.compact(); });
  for (int i = 0; i < 2; ++i) append_late(archive);
  archive.compact();
  EXPECT_EQ(contents(third), contents(path));
  EXPECT_THAT(findings(third), IsEmpty());
}

TEST_F(LostShard, DamageInsideItLosesNothing) {
  const std::function<void()> damages[] = {
      [&] { rows(file_, "UPDATE chunk_data SET bytes = zeroblob(200)"); },
      [&] { fs::resize_file(file_, fs::file_size(file_) / 2); }};
  Time late = begin_2023;
  for (const auto& damage : damages) {
    late += 60 * day;
    damage();
    const AppendReport report = append_late(archive, late);
    EXPECT_THAT(report.postponed, HasSubstr(file_.string()));
    EXPECT_THAT(report.damages, IsEmpty());
    archive.compact();
    EXPECT_THAT(findings(path), Not(IsEmpty()));
    put_back();
    archive.compact();
    append_late(whole_archive_, late);
    whole_archive_.compact();
    EXPECT_EQ(contents(path), contents(whole_));
    EXPECT_THAT(findings(path), IsEmpty());
  }
}

TEST_F(Split, ABackupTakesTheShardsAlongOnceEach) {
  const SplitReport report = split();
  const fs::path copy = folder / "copy.db";
  const auto back_up_all = [&] {
    return *back_up(database, copy, {.replace = true}, [](const auto&) { return true; });
  };
  EXPECT_EQ(back_up_all().shard_bytes, report.made[0].bytes + report.made[1].bytes);
  EXPECT_EQ(contents(copy), contents(path));
  EXPECT_THAT(findings(copy), IsEmpty());
  append(begin_2025 + 200 * day, begin_2025 + 201 * day);
  const BackupReport again = back_up_all();
  EXPECT_EQ(again.shards, 2U);
  EXPECT_EQ(again.shard_bytes, 0U);
  EXPECT_EQ(contents(copy), contents(path));
}

TEST_F(LostShard, ABackupDoesNotKeepADamagedOne) {
  const fs::path earlier = copied("earlier.db");
  rows(file_, "UPDATE chunk_data SET bytes = zeroblob(length(bytes)) WHERE id = 1");
  const fs::path copy = folder / "copy.db";
  EXPECT_THAT(error_of([&] { back_up(database, copy, {}, [](const auto&) { return true; }); }),
              AllOf(StartsWith("corrupt: "), HasSubstr(file_.string())));
  EXPECT_FALSE(fs::exists(copy));
  EXPECT_FALSE(fs::exists(fs::path(copy.string() + ".shards") / file_.filename()));
  EXPECT_EQ(
      back_up(database, earlier, {.replace = true}, [](const auto&) { return true; })->shard_bytes,
      0U)
      << "it has the whole one";
}

TEST_F(Split, RetentionRemovesAShardOfWhichNothingIsLeft) {
  const SplitReport report = split();
  const auto keep = [&](Time age) {
    Retention retention(archive, {.keep = age}, {}, latest);
    while (retention.step()) {
    }
    return retention.report();
  };
  EXPECT_GT(keep(300 * day).chunks, 0U);
  EXPECT_THAT(findings(path), IsEmpty());
  keep(300 * day);
  EXPECT_FALSE(fs::exists(shard(report, 0)));
  EXPECT_TRUE(fs::exists(shard(report, 1)));
  EXPECT_THAT(rows(path, "SELECT file FROM shard"), ElementsAre(report.made[1].file));
  EXPECT_THAT(findings(path), IsEmpty());
}

TEST_F(Split, CountsTheRoomOfWhatIsInShards) {
  const std::uint64_t before = plan_retention(database, {}, {}, latest).bytes_in_use;
  const SplitReport report = split();
  const std::uint64_t after = plan_retention(database, {}, {}, latest).bytes_in_use;
  // A shard has pages of its own for tables that are empty.
  EXPECT_GT(after, before / 2);
  EXPECT_LT(after, before + report.made[0].bytes + report.made[1].bytes);
  Retention retention(archive, {.max_bytes = after - report.made[0].bytes / 2}, {}, latest);
  while (retention.step()) {
  }
  EXPECT_GT(retention.report().chunks, 0U);
  EXPECT_LT(retention.report().chunks, report.made[0].chunks);
  EXPECT_THAT(findings(path), IsEmpty());
}

/// Runs `work` in a process that kills itself at its file operation number `last`. True where it
/// was killed, false where it came to its end before.
bool is_killed_at(std::uint64_t last, const std::function<void()>& work) {
  const pid_t process = ::fork();
  if (process == 0) {
    std::uint64_t count = 0;
    try {
      const WatchedFiles watched([&](const FileOperation&) {
        if (++count < last) return WatchedFiles::Fate::happens;
        return last % 2 == 0 ? WatchedFiles::Fate::killed_half_way
                             : WatchedFiles::Fate::killed_before;
      });
      work();
    } catch (...) {
      ::_exit(2);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << "the split failed by itself";
  return WIFSIGNALED(status);
}

TEST_F(Split, AKillAtAnyMomentLeavesEverySampleReadableOnce) {
  const auto before = contents(path);
  database = Database(folder / "other.db", Mode::read_write);  // closes the file
  const fs::path whole = folder / "whole.db";
  fs::copy(path, whole);
  const auto work = [&] {
    Database opened(path, Mode::read_write);
    Archive own(opened, small_chunks);
    split_by_year(own, 2025, to_the_end);
    give_back_room(opened);
  };
  int kills = 0, between = 0;
  for (std::uint64_t operation = 1;; operation += 1 + operation / 2) {
    SCOPED_TRACE("killed at file operation " + std::to_string(operation));
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path.string() + suffix);
    fs::remove_all(path.string() + ".shards");
    fs::copy(whole, path);
    if (!is_killed_at(operation, work)) break;
    ++kills;
    ASSERT_EQ(contents(path), before);
    const std::uint64_t moved = chunks_of_shards();
    work();
    ASSERT_EQ(contents(path), before);
    ASSERT_THAT(findings(path), IsEmpty());
    between += moved > 0 && moved < chunks_of_shards() ? 1 : 0;
  }
  EXPECT_GT(kills, 8);
  EXPECT_GT(between, 0);
}

}  // namespace
}  // namespace reident::storage::test::split_test
