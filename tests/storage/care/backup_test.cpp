#include "storage/care/backup.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fcntl.h>
#include <set>
#include <thread>
#include <unistd.h>

#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "storage/database/connection.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::backup_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Mode = Database::Mode;

constexpr Time second = 1'000'000'000;

bool to_the_end(const BackupProgress&) {
  return true;
}

class Backup : public ArchiveTest {
 protected:
  Backup() { fill(0, 2000); }

  /// Ten frames an append, eight samples a frame.
  void fill(std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t first = from; first < to; first += 10) {
      std::vector<TelemetryFrame> frames;
      for (std::uint64_t k = first; k < first + 10; ++k) frames.push_back(frame_at(k));
      archive.append(frames);
    }
  }
  static TelemetryFrame frame_at(std::uint64_t k) {
    std::vector<Sample> samples;
    for (std::uint32_t p = 1; p <= 8; ++p)
      samples.push_back({p, Quality::good, static_cast<double>(k * p) / 7});
    return frame(k, static_cast<Time>(k) * second, samples);
  }
  BackupReport back_up_all(bool replace = false) {
    return *back_up(database, copy, {.replace = replace}, to_the_end);
  }
  std::string refusal(const fs::path& to, bool replace = false) {
    return error_of([&] { back_up(database, to, {.replace = replace}, to_the_end); });
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      names.insert(entry.path().filename());
    return names;
  }

  fs::path copy = folder / "copy.db";
};

TEST_F(Backup, SaysWhatItCopiedAndTheCopyHoldsIt) {
  const BackupReport report = back_up_all();
  EXPECT_EQ(report.copy, copy);
  EXPECT_EQ(report.bytes, fs::file_size(copy));
  EXPECT_EQ(report.samples, 16000U);
  EXPECT_EQ(report.versions, 0U);
  EXPECT_EQ(report.newest, 1999 * second);
  Database opened(copy, Mode::read_only);
  const Archive again(opened);
  for (std::uint32_t p = 1; p <= 8; ++p) {
    const Series from = read_all(archive, p), to = read_all(again, p);
    EXPECT_EQ(from.time, to.time);
    EXPECT_EQ(from.value, to.value);
  }
}

TEST_F(Backup, LeavesTheCopyAloneInItsFolderReadyToBeWritten) {
  const std::set<std::string> before = files();
  back_up_all();
  std::set<std::string> after = files();
  EXPECT_EQ(after.erase("copy.db"), 1U);
  EXPECT_EQ(after, before);
  Database opened(copy, Mode::read_write);
  EXPECT_EQ(Archive(opened).append(std::vector{frame_at(5000)}).stored, 8U);
  EXPECT_THAT(rows(copy, "PRAGMA journal_mode"), ElementsAre("wal"));
}

TEST_F(Backup, CanBeReadByThoseAloneWhoCanReadTheSource) {
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  back_up_all();
  EXPECT_EQ(fs::status(copy).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Backup, IsOneMomentAndNeverBeginsAnewWhileAnotherProcessWrites) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  Database reader(path, Mode::read_only);
  const std::uint64_t before = Archive(reader).sample_count();
  database = Database(folder / "other.db", Mode::read_write);  // gives up the lock
  char turn = '+';
  const pid_t writer = ::fork();
  if (writer == 0) {
    ::close(ends[0]);  // so that it ends with the other one
    Database own(path, Mode::read_write);
    Archive target(own);
    // Only when it is told to: what it wrote ahead would not be between two steps.
    for (std::uint64_t k = 2000; ::read(ends[1], &turn, 1) == 1; ++k) {
      target.append(std::vector{frame_at(k)});
      if (::write(ends[1], &turn, 1) != 1) break;
    }
    ::_exit(1);
  }
  std::uint64_t appends = 0;
  std::vector<BackupProgress> steps;
  const auto report = back_up(reader, copy, {.pages_of_step = 4}, [&](const BackupProgress& step) {
    steps.push_back(step);
    appends += ::write(ends[0], &turn, 1) == 1 && ::read(ends[0], &turn, 1) == 1;
    return true;
  });
  ::kill(writer, SIGKILL);
  ::waitpid(writer, nullptr, 0);
  ASSERT_GT(steps.size(), 20U);
  EXPECT_EQ(appends, steps.size());
  EXPECT_EQ(steps.size(), (steps[0].pages - 1) / 4) << "no step was done twice";
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].pages, steps[0].pages);
    EXPECT_EQ(steps[i].done, 4 * (i + 1));
  }
  EXPECT_EQ(report->samples, before) << "the moment at which it began";
  Database opened(copy, Mode::read_only);
  EXPECT_EQ(Archive(opened).sample_count(), report->samples);
  EXPECT_EQ(read_all(Archive(opened), 8).time.size(), report->samples / 8);
  EXPECT_THAT(rows(copy, "PRAGMA integrity_check"), ElementsAre("ok"));
  EXPECT_EQ(Archive(reader).sample_count(), before + 8 * appends);
}

TEST_F(Backup, RefusesAFileThatExistsUnlessToldToReplaceIt) {
  write_file(copy, "precious");
  EXPECT_THAT(refusal(copy), StartsWith("cannot_open: backup " + copy.string() +
                                        " exists already: name another file, or replace"));
  EXPECT_EQ(read_file(copy), "precious");
  EXPECT_EQ(back_up_all(true).samples, 16000U);
  fill(2000, 2100);
  EXPECT_EQ(back_up_all(true).samples, 16800U);
  Database opened(copy, Mode::read_only);
  EXPECT_EQ(Archive(opened).sample_count(), 16800U);
}

TEST_F(Backup, RefusesTheSourceUnderAnyName) {
  fs::create_symlink(path, folder / "link.db");
  fs::create_hard_link(path, folder / "hard.db");
  for (const char* name : {"archive.db", "link.db", "hard.db"})
    EXPECT_THAT(refusal(folder / name, true), HasSubstr("is the database itself")) << name;
  for (const char* name :
       {"archive.db-wal", "archive.db-shm", "archive.db-journal", "archive.db.lock"})
    EXPECT_THAT(refusal(folder / name, true), HasSubstr("is a name that belongs to")) << name;
  EXPECT_EQ(archive.sample_count(), 16000U);
  EXPECT_EQ(read_all(archive, 1).time.size(), 2000U);
}

TEST_F(Backup, RefusesWhatCannotBeAFileBeforeItWritesAnything) {
  EXPECT_THAT(refusal(folder.path()), HasSubstr("is a folder: name a file in it"));
  EXPECT_THAT(refusal(folder / "no" / "copy.db"),
              HasSubstr("the folder " + (folder / "no").string() + " does not exist"));
  EXPECT_THAT(refusal("/dev/null", true), HasSubstr("is not a regular file"));
  EXPECT_FALSE(fs::exists(folder / "no"));
}

TEST_F(Backup, ReplacesWhatALinkLeadsToAndKeepsTheLink) {
  fs::create_directory(folder / "far");
  write_file(folder / "far" / "real.db", "old");
  fs::create_symlink(folder / "far" / "real.db", copy);
  EXPECT_EQ(back_up_all(true).copy, folder / "far" / "real.db");
  EXPECT_TRUE(fs::is_symlink(copy));
  Database opened(copy, Mode::read_only);
  EXPECT_EQ(Archive(opened).sample_count(), 16000U);
}

// SQLite would fold such a log into the new file.
TEST_F(Backup, RefusesANameBesideWhichTheLogOfAnotherFileStands) {
  for (const char* suffix : {"-wal", "-journal"}) {
    write_file(copy.string() + suffix, "frames");
    for (const bool replace : {false, true})
      EXPECT_THAT(refusal(copy, replace), HasSubstr("is next to it"));
    fs::remove(copy.string() + suffix);
  }
  const Database other(copy, Mode::read_write);
  EXPECT_THAT(refusal(copy, true), HasSubstr(copy.string()));
  EXPECT_FALSE(fs::exists(copy.string() + ".partial"));
}

TEST_F(Backup, RefusesToReplaceADatabaseThatAServiceHolds) {
  const Database other(copy, Mode::read_write);
  fs::remove(copy.string() + "-wal");
  EXPECT_THAT(refusal(copy, true), StartsWith("locked: "));
}

TEST_F(Backup, ThatIsStoppedLeavesNothing) {
  const std::set<std::string> before = files();
  int steps = 0;
  EXPECT_FALSE(back_up(database, copy, {.pages_of_step = 4}, [&](auto&) { return ++steps < 3; }));
  EXPECT_EQ(files(), before);
  EXPECT_EQ(archive.append(std::vector{frame_at(2000)}).stored, 8U) << "the source is free again";
}

TEST_F(Backup, ReplacesWhatAKilledOneLeftAndWaitsForNoOneElses) {
  const fs::path partial = copy.string() + ".partial";
  write_file(partial, "half a backup");
  const int other = ::open(partial.c_str(), O_RDONLY);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  EXPECT_THAT(refusal(copy), StartsWith("locked: file " + partial.string()));
  EXPECT_EQ(read_file(partial), "half a backup");
  ::close(other);
  EXPECT_EQ(back_up_all().samples, 16000U);
  EXPECT_FALSE(fs::exists(partial));
}

TEST_F(Backup, ToAFullDiskLeavesNothingAndSaysSo) {
  const std::set<std::string> before = files();
  const std::string outcome = in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{200'000, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return refusal(copy);
  });
  EXPECT_THAT(outcome, StartsWith("full: "));
  EXPECT_THAT(outcome, HasSubstr(copy.string()));
  EXPECT_EQ(files(), before);
  EXPECT_EQ(back_up_all().samples, 16000U);
}

TEST_F(Backup, WithoutPermissionToWriteTheTargetIsRefused) {
  fs::create_directory(folder / "closed");
  fs::permissions(folder / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  fs::permissions(path, fs::perms::all);
  fs::permissions(path.string() + "-wal", fs::perms::all);
  fs::permissions(path.string() + "-shm", fs::perms::all);
  const std::string outcome = in_unprivileged_child([&]() -> std::string {
    Database own(path, Mode::read_only);
    return error_of([&] { back_up(own, folder / "closed" / "copy.db", {}, to_the_end); });
  });
  EXPECT_THAT(outcome, StartsWith("read_only: file " + (folder / "closed").string()));
}

TEST_F(Backup, OfASourceThatCannotBeWrittenWorks) {
  fs::create_directory(folder / "sealed");
  back_up_all();
  fs::rename(copy, folder / "sealed" / "archive.db");
  fs::permissions(folder / "sealed" / "archive.db", fs::perms(0444));
  fs::permissions(folder / "sealed", fs::perms(0555));
  const std::string outcome = in_unprivileged_child([&] {
    Database own(folder / "sealed" / "archive.db", Mode::read_only);
    return std::to_string(back_up(own, copy, {}, to_the_end)->samples);
  });
  fs::permissions(folder / "sealed", fs::perms::all);
  EXPECT_EQ(outcome, "16000");
}

TEST_F(Backup, OfADamagedSourceNamesTheSourceAndLeavesNothing) {
  back_up_all();
  fs::path damaged = folder / "damaged.db";
  // A file whose first page promises more pages than it has, behind SQLite's back.
  Database victim(copy, Mode::read_write);
  EXPECT_EQ(Archive(victim).append(std::vector{frame_at(9000)}).stored, 8U);
  ASSERT_EQ(::truncate(copy.c_str(), 8192), 0);
  const std::string outcome =
      error_of([&] { back_up(victim, damaged, {.pages_of_step = 4}, to_the_end); });
  EXPECT_THAT(outcome, HasSubstr("database " + copy.string()));
  EXPECT_FALSE(fs::exists(damaged));
  EXPECT_FALSE(fs::exists(damaged.string() + ".partial"));
}

}  // namespace
}  // namespace reident::storage::test::backup_test
