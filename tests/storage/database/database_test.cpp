// What may be opened, how, and what is said of the rest.
#include "storage/database/database.hpp"

#include <atomic>
#include <csignal>
#include <thread>
#include <unistd.h>

#include <sys/stat.h>
#include <sys/wait.h>

#include "storage/database/schema.hpp"
#include "storage/database/snapshot.hpp"
#include "storage/database/sqlite.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::database_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Mode = Database::Mode;

const std::vector<TelemetryFrame> one_sample{frame(1, 10, {{1, Quality::good, 1}})};

std::string opening(const fs::path& path, Mode mode) {
  return error_of([&] { const Database database(path, mode); });
}

void make_archive(const fs::path& path) {
  Database database(path, Mode::read_write);
  Archive(database).append(one_sample);
}

/// How many samples a reader of the file finds, or the error that it gets.
std::string reader_finds(const fs::path& path) {
  std::string count;
  const std::string error = error_of([&] {
    Database database(path, Mode::read_only);
    count = std::to_string(Archive(database).sample_count());
  });
  return count.empty() ? error : count;
}

TEST(Database, MakesAFileThatIsMarkedAsOurs) {
  const TemporaryFolder folder;
  make_archive(folder / "a.db");
  EXPECT_THAT(rows(folder / "a.db",
                   "PRAGMA application_id; PRAGMA user_version;"
                   "PRAGMA journal_mode; PRAGMA integrity_check"),
              ElementsAre("1919248740", std::to_string(schema::version), "wal", "ok"));
}

TEST(Database, IsOneStateForAllThatASnapshotReads) {
  const TemporaryFolder folder;
  make_archive(folder / "a.db");
  Database writer(folder / "a.db", Mode::update), reader(folder / "a.db", Mode::read_only);
  {
    const Snapshot snapshot(reader);
    EXPECT_EQ(Archive(reader).sample_count(), 1U);
    Archive(writer).append(std::vector{frame(2, 20, {{1, Quality::good, 2}})});
    EXPECT_EQ(Archive(reader).sample_count(), 1U);
  }
  EXPECT_EQ(Archive(reader).sample_count(), 2U);
}

TEST(Database, FindsItsContentsAgain) {
  const TemporaryFolder folder;
  make_archive(folder / "a.db");
  Database again(folder / "a.db", Mode::read_write);
  EXPECT_EQ(Archive(again).sample_count(), 1U);
  EXPECT_EQ(Archive(again).append(one_sample).duplicates, 1U);
}

TEST(Database, RefusesWhatItCannotUse) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder");
  std::string garbage(20000, '\0');
  for (std::size_t i = 0; i < garbage.size(); ++i) garbage[i] = static_cast<char>(i * i * 7 + 13);
  write_file(folder / "garbage", garbage);
  write_file(folder / "text", "time,V_BUS\n0,28.1\n");
  { const Database made(folder / "made.db", Mode::read_write); }
  std::string no_page_size = read_file(folder / "made.db");
  no_page_size.replace(16, 2, 2, '\0');
  write_file(folder / "no_page_size", no_page_size);
  rows(folder / "foreign.db", "CREATE TABLE theirs (x); INSERT INTO theirs VALUES (1)");
  rows(folder / "foreign2.db", "CREATE TABLE theirs (x); PRAGMA application_id = 77");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);

  const struct {
    const char* name;
    const char* error;
  } table[] = {
      {"folder", "is a folder"},
      {"no/such/a.db", "its folder does not exist"},
      {"garbage", "is not a database"},
      {"text", "is not a database"},
      {"no_page_size", "is not a database"},
      {"foreign.db", "was not made by reident"},
      {"foreign2.db", "was not made by reident"},
      {"pipe", "is not a regular file"},
  };
  for (const auto& [file, error] : table)
    for (const Mode mode : {Mode::read_write, Mode::read_only}) {
      const std::string said = opening(folder / file, mode);
      EXPECT_THAT(said, StartsWith("cannot_open: ")) << file;
      EXPECT_THAT(said, HasSubstr((folder / file).string())) << file;
      EXPECT_THAT(said, HasSubstr(error)) << file;
    }
  EXPECT_EQ(read_file(folder / "garbage"), garbage) << "left as it was";
  EXPECT_THAT(rows(folder / "foreign.db", "SELECT x FROM theirs; PRAGMA journal_mode"),
              ElementsAre("1", "delete"));
}

TEST(Database, SaysThatAFileToReadDoesNotExist) {
  const TemporaryFolder folder;
  EXPECT_THAT(opening(folder / "a.db", Mode::read_only),
              AllOf(StartsWith("cannot_open: "), HasSubstr("does not exist")));
  EXPECT_FALSE(fs::exists(folder / "a.db")) << "reading makes no file";
}

TEST(Database, HoldsNoValueThatWouldTakeAllMemory) {
  sqlite::Connection connection(":memory:", "a.db", SQLITE_OPEN_READWRITE);
  EXPECT_THAT(error_of([&] { connection.execute("SELECT zeroblob(300000000)"); }),
              StartsWith("corrupt: "));
  EXPECT_EQ(error_of([&] { connection.execute("SELECT zeroblob(1000000)"); }), "no error");
}

TEST(Database, TakesAnEmptyFileForANewOne) {
  const TemporaryFolder folder;
  write_file(folder / "a.db", "");
  EXPECT_THAT(opening(folder / "a.db", Mode::read_only), StartsWith("cannot_open: "));
  EXPECT_EQ(opening(folder / "a.db", Mode::read_write), "no error");
}

TEST(Database, RefusesANewerSchemaAndLeavesItAlone) {
  const TemporaryFolder folder;
  make_archive(folder / "a.db");
  rows(folder / "a.db", "PRAGMA user_version = 99");
  for (const Mode mode : {Mode::read_write, Mode::read_only})
    EXPECT_THAT(opening(folder / "a.db", mode),
                AllOf(StartsWith("newer_schema: "), HasSubstr("schema version 99"),
                      HasSubstr("use a newer reident")));
  EXPECT_THAT(rows(folder / "a.db", "PRAGMA user_version"), ElementsAre("99"));
}

TEST(Database, FindsAFileThatWasCutShort) {
  const TemporaryFolder folder;
  make_archive(folder / "whole.db");
  const auto whole = static_cast<std::size_t>(fs::file_size(folder / "whole.db"));
  const std::string bytes = read_file(folder / "whole.db");
  for (const std::size_t length : {whole - 4096, whole - 1, whole / 2, std::size_t{4096}}) {
    write_file(folder / "cut.db", bytes.substr(0, length));
    for (const Mode mode : {Mode::read_write, Mode::read_only})
      EXPECT_THAT(opening(folder / "cut.db", mode),
                  AllOf(StartsWith("corrupt: "), HasSubstr("restore a backup")))
          << length << " of " << whole << " bytes";
    EXPECT_EQ(read_file(folder / "cut.db").size(), length) << "what is left can still be recovered";
  }
  write_file(folder / "cut.db", bytes.substr(0, 100));
  EXPECT_THAT(opening(folder / "cut.db", Mode::read_write), StartsWith("corrupt: "));
}

/// A process that holds the database open for writing and has appended one sample; killed at the
/// end. (SQLite's connections must not be carried into a forked child, so it is the one that
/// opens.)
class RunningWriter {
 public:
  explicit RunningWriter(const fs::path& path) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      try {
        Database database(path, Mode::read_write);
        Archive(database).append(one_sample);
        if (::write(ends[1], "+", 1) == 1)
          for (;;) ::pause();
      } catch (...) {
      }
      ::_exit(1);
    }
    ::close(ends[1]);
    char ready = 0;
    if (::read(ends[0], &ready, 1) != 1) throw std::runtime_error("the writer did not start");
    ::close(ends[0]);
  }
  ~RunningWriter() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  RunningWriter(const RunningWriter&) = delete;
  RunningWriter& operator=(const RunningWriter&) = delete;
  std::string pid() const { return std::to_string(process_); }

 private:
  pid_t process_;
};

std::string in_use_by(const fs::path& path, const std::string& pid) {
  return "locked: database " + path.string() + " is in use by process " + pid +
         "; stop it or use another database";
}

TEST(Database, RefusesASecondWriterAndNamesTheFirst) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  fs::create_symlink(path, folder / "other name.db");
  const RunningWriter writer(path);
  EXPECT_EQ(opening(path, Mode::read_write), in_use_by(path, writer.pid()));
  EXPECT_EQ(opening(folder / "other name.db", Mode::read_write), in_use_by(path, writer.pid()))
      << "by another name of the same file";
}

TEST(Database, RefusesAnEmptyFileWhoseLogHoldsData) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  { const RunningWriter killed(path); }
  write_file(path, "");
  for (const Mode mode : {Mode::read_write, Mode::read_only})
    EXPECT_THAT(opening(path, mode), AllOf(StartsWith("corrupt: "), HasSubstr("a.db-wal")));
  EXPECT_GT(fs::file_size(path.string() + "-wal"), 0U);
}

TEST(Database, RefusesASecondWriterInItsOwnProcess) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  const Database writer(path, Mode::read_write);
  EXPECT_EQ(opening(path, Mode::read_write), in_use_by(path, std::to_string(::getpid())));
}

TEST(Database, IsOpenedForWritingWhileOthersAskWhetherItHasAWriter) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  make_archive(path);
  std::atomic<bool> begun = false, ended = false;
  std::thread asking([&] {
    for (; !ended; begun = true) Database::has_writer(path);
  });
  while (!begun) std::this_thread::yield();
  for (int i = 0; i < 50; ++i) EXPECT_EQ(opening(path, Mode::read_write), "no error");
  ended = true;
  asking.join();
}

TEST(Database, FreesTheLockWhenItsWriterEndsInWhateverWay) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  make_archive(path);
  EXPECT_EQ(opening(path, Mode::read_write), "no error") << "closed";
  { const RunningWriter killed(path); }
  EXPECT_EQ(opening(path, Mode::read_write), "no error") << "killed";
}

TEST(Database, LeavesALockFileThatTheOwnerOfTheDatabaseCanUse) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  ASSERT_EQ(in_unprivileged_child([&] { return opening(path, Mode::read_write); }), "no error");
  ASSERT_EQ(opening(path, Mode::read_write), "no error") << "as another user, or as root";
  fs::remove(path.string() + ".lock");
  ASSERT_EQ(opening(path, Mode::read_write), "no error");
  EXPECT_EQ(in_unprivileged_child([&] { return opening(path, Mode::read_write); }), "no error");
}

TEST(Database, KeepsItsLockWhenItIsMoved) {
  const TemporaryFolder folder;
  Database first(folder / "a.db", Mode::read_write);
  const Database second(std::move(first));
  EXPECT_EQ(second.path(), folder / "a.db");
  EXPECT_THAT(opening(folder / "a.db", Mode::read_write), StartsWith("locked: "));
}

TEST(Database, IsLockedWhileAnotherProgramHoldsATransaction) {
  const TemporaryFolder folder;
  Database writer(folder / "a.db", Mode::read_write);
  sqlite3* shell = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "a.db").c_str(), &shell), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(shell, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_THAT(error_of([&] { Archive(writer).append(one_sample); }),
              AllOf(StartsWith("locked: "), HasSubstr("another program")));
  sqlite3_close(shell);
  EXPECT_EQ(Archive(writer).append(one_sample).stored, 1U);
}

TEST(Database, ReadersWorkWhetherOrNotAWriterRuns) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  {
    Database writer(path, Mode::read_write);
    Archive(writer).append(one_sample);
    EXPECT_EQ(reader_finds(path), "1") << "while the writer runs";
  }
  EXPECT_EQ(reader_finds(path), "1") << "after it stopped";
  EXPECT_EQ(reader_finds(path), "1") << "after a reader was the last one";
  const fs::path other = folder / "b.db";
  { const RunningWriter killed(other); }
  EXPECT_EQ(reader_finds(other), "1") << "after the writer was killed";
}

// The last program to close a database takes its log away, and file locks show whether it is the
// last. They are the process's: whoever closes any descriptor of the file drops them.
TEST(Database, KeepsItsLogWhenAnotherProgramOpensAndClosesTheFile) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  { const Database made(path, Mode::read_write); }
  int wake[2];
  ASSERT_EQ(::pipe(wake), 0);
  const pid_t other = ::fork();  // before this process has the file open
  if (other == 0) {
    char byte = 0;
    ::close(wake[1]);
    if (::read(wake[0], &byte, 1) < 0) ::_exit(1);
    ::_exit(rows(path, "SELECT count(*) FROM series").size() == 1 ? 0 : 1);
  }
  Database writer(path, Mode::read_write);
  const Database reader(path, Mode::read_only);
  Archive(writer).append(std::vector{frame(1, 1, {{1, Quality::good, 1.5}})});
  ::close(wake[1]);
  int status = 0;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::exists(path.string() + "-wal"));
  Archive(writer).append(std::vector{frame(2, 2, {{1, Quality::good, 2.5}})});
  EXPECT_THAT(rows(path, "SELECT sum(samples) FROM series"), ::testing::ElementsAre("2"));
}

TEST(Database, AUserWhoMayOnlyReadFollowsARunningWriter) {
  const TemporaryFolder folder;
  const RunningWriter writer(folder / "a.db");
  fs::permissions(folder.path(),
                  fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
  EXPECT_EQ(in_unprivileged_child([&] { return reader_finds(folder / "a.db"); }), "1");
}

/// A folder without write permission that holds a copy of the files of `path` named in `suffixes`.
void copy_to_sealed_folder(const fs::path& path, const std::vector<std::string>& suffixes,
                           const fs::path& sealed) {
  fs::create_directory(sealed);
  for (const std::string& suffix : suffixes) {
    fs::copy_file(path.string() + suffix, (sealed / "a#1%20?.db").string() + suffix);
    fs::permissions((sealed / "a#1%20?.db").string() + suffix,
                    fs::perms::owner_read | fs::perms::others_read);
  }
  fs::permissions(sealed, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                              fs::perms::others_exec);
}

TEST(Database, ReadersWorkInAFolderThatCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  make_archive(path);
  copy_to_sealed_folder(path, {""}, folder / "closed");
  // A copy of the files of a running writer: the second sample is in the log alone.
  Database writer(path, Mode::read_write);
  Archive(writer).append(std::vector{frame(2, 20, {{1, Quality::good, 2}})});
  copy_to_sealed_folder(path, {"", "-wal", "-shm"}, folder / "running");
  copy_to_sealed_folder(path, {"", "-wal"}, folder / "log alone");
  fs::copy(folder / "closed", folder / "empty log");
  write_file((folder / "empty log" / "a#1%20?.db").string() + "-wal", "");

  const auto finds = [&](const std::string& name) {
    return in_unprivileged_child([&] { return reader_finds(folder / name / "a#1%20?.db"); });
  };
  EXPECT_EQ(finds("closed"), "1");
  EXPECT_EQ(finds("running"), "2");
  EXPECT_EQ(finds("empty log"), "1");
  EXPECT_THAT(finds("log alone"), AllOf(StartsWith("cannot_open: "), HasSubstr("-wal"),
                                        HasSubstr("copy both to a folder that can be written")));
  for (const char* name : {"closed", "running", "empty log", "log alone"})
    fs::permissions(folder / name, fs::perms::all);
}

TEST(Database, SaysThatItCannotWrite) {
  const TemporaryFolder folder;
  make_archive(folder / "a.db");
  copy_to_sealed_folder(folder / "a.db", {""}, folder / "sealed");
  fs::copy_file(folder / "a.db", folder / "b.db");
  fs::permissions(folder / "b.db", fs::perms::owner_read | fs::perms::others_read);
  write_file(folder / "secret.db", read_file(folder / "a.db"));
  fs::permissions(folder / "secret.db", fs::perms::none);

  const auto writing = [&](const fs::path& path) {
    return in_unprivileged_child([&] { return opening(path, Mode::read_write); });
  };
  EXPECT_THAT(writing(folder / "sealed" / "a#1%20?.db"),
              AllOf(StartsWith("read_only: "), HasSubstr("folder")))
      << "folder without permission";
  EXPECT_THAT(writing(folder / "b.db"), AllOf(StartsWith("read_only: "), HasSubstr("b.db")))
      << "file without permission";
  EXPECT_THAT(writing(folder / "secret.db"),
              AllOf(StartsWith("cannot_open: "), HasSubstr("permissions")));
  fs::permissions(folder / "sealed", fs::perms::all);
}

}  // namespace
}  // namespace reident::storage::test::database_test
