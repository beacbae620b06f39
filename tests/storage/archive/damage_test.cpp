// Damage that others do to the files of an archive: found, named, and nothing committed lost that
// is still there.
#include <map>
#include <random>
#include <unistd.h>

#include "tests/storage/archive/writer_session.hpp"
#include "tests/storage/expected_archive.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::damage_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Mode = Database::Mode;

std::vector<TelemetryFrame> one_sample(std::uint64_t number) {
  return {frame(number, static_cast<Time>(number), {{1, Quality::good, 1.5}})};
}

std::string appending(Database& database, std::uint64_t number) {
  return error_of([&] { Archive(database).append(one_sample(number)); });
}

std::string opening(const fs::path& path, Mode mode = Mode::read_write) {
  return error_of([&] { const Database database(path, mode); });
}

void cut_to(const fs::path& path, std::uintmax_t length) {
  fs::resize_file(path, length);
}

void flip_bit(std::string& bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
}

// ---- others at the files of an archive that is open

TEST(FilesInUse, AVisitorLeavesTheLogOfAWriterThatHasJustStarted) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  { const Database made(path, Mode::read_write); }
  Database writer(path, Mode::read_write);
  const Database reader(path, Mode::read_only);  // of the same process
  ASSERT_EQ(in_child([&] { return rows(path, "SELECT count(*) FROM source").at(0); }), "0");
  EXPECT_TRUE(fs::exists(path.string() + "-wal")) << "the visitor took itself for the last one";
  EXPECT_EQ(appending(writer, 1), "no error");
}

TEST(FilesInUse, AFileThatWasTakenAwayIsMissedAndTakenUpAgain) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db", away = folder / "away.db";
  Database database(path, Mode::read_write);
  ASSERT_EQ(appending(database, 1), "no error");
  fs::rename(path, away);
  EXPECT_THAT(appending(database, 2),
              AllOf(StartsWith("displaced: database " + path.string()),
                    HasSubstr("deleted or moved while it was in use"), HasSubstr("put it back")));
  fs::copy_file(away, path);
  EXPECT_THAT(appending(database, 2), HasSubstr("replaced by another file"));
  fs::rename(away, path);
  EXPECT_EQ(appending(database, 2), "no error");
  EXPECT_EQ(Archive(database).sample_count(), 2U);
}

TEST(FilesInUse, AFileOfTheDatabaseThatWasTakenAwayIsMissedAndWhatWasStoredIsSavedAtTheEnd) {
  for (const char* suffix : {"-wal", "-shm", ".lock"}) {  // without the lock there may be two
    SCOPED_TRACE(suffix);
    const TemporaryFolder folder;
    const fs::path path = folder / "a.db";
    {
      Database database(path, Mode::read_write);
      ASSERT_EQ(appending(database, 1), "no error");
      fs::remove(path.string() + suffix);
      EXPECT_THAT(appending(database, 2),
                  AllOf(StartsWith("displaced: "), HasSubstr(path.string() + suffix),
                        HasSubstr("stop process " + std::to_string(::getpid()))));
    }
    Database again(path, Mode::read_write);
    EXPECT_EQ(Archive(again).sample_count(), 1U);
    EXPECT_EQ(appending(again, 2), "no error");
  }
}

TEST(FilesInUse, ACheckpointThatAReaderKeepsFromItsEndIsNoCut) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  Database database(path, Mode::read_write);
  ASSERT_EQ(appending(database, 1), "no error");
  sqlite3 *writer = nullptr, *reader = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &writer), SQLITE_OK);
  ASSERT_EQ(sqlite3_open(path.c_str(), &reader), SQLITE_OK);
  const auto run = [](sqlite3* connection, const char* sql) {
    EXPECT_EQ(sqlite3_exec(connection, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  };
  run(writer, "CREATE TABLE filler (x); INSERT INTO filler VALUES (zeroblob(40000))");
  run(reader, "BEGIN; SELECT count(*) FROM filler");
  const std::uintmax_t before = fs::file_size(path);
  run(writer, "UPDATE filler SET x = randomblob(40000); PRAGMA wal_checkpoint(PASSIVE)");
  ASSERT_LT(fs::file_size(path), before + 40'000) << "the last pages stay in the log";
  EXPECT_EQ(appending(database, 2), "no error");
  sqlite3_close(reader);
  sqlite3_close(writer);
}

TEST(FilesInUse, AFileThatIsCutBehindItsCheckpointIsMendedFromItsLogByTheNextStart) {
  for (const bool more_to_copy : {false, true}) {
    SCOPED_TRACE(more_to_copy);
    const TemporaryFolder folder;
    const fs::path path = folder / "a.db";
    {
      Database database(path, Mode::read_write);
      ASSERT_EQ(appending(database, 1), "no error");
      sqlite3 *writer = nullptr, *reader = nullptr;
      ASSERT_EQ(sqlite3_open(path.c_str(), &writer), SQLITE_OK);
      ASSERT_EQ(sqlite3_open(path.c_str(), &reader), SQLITE_OK);
      const auto run = [](sqlite3* connection, const char* sql) {
        EXPECT_EQ(sqlite3_exec(connection, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
      };
      run(writer,
          "PRAGMA wal_checkpoint(PASSIVE); CREATE TABLE small (x); CREATE TABLE filler (x)");
      run(writer, "INSERT INTO filler VALUES (zeroblob(40000))");
      const std::uintmax_t before = fs::file_size(path);
      run(reader, "BEGIN; SELECT count(*) FROM filler");  // keeps the log from its start
      run(writer, "PRAGMA wal_checkpoint(PASSIVE)");
      ASSERT_GT(fs::file_size(path), before) << "the log is copied";
      if (more_to_copy) run(writer, "INSERT INTO small VALUES (1)");
      sqlite3_close(reader);
      sqlite3_close(writer);
      cut_to(path, before);
      EXPECT_THAT(appending(database, 2),
                  AllOf(StartsWith("corrupt: database " + path.string() + " was cut short"),
                        HasSubstr("its log has the rest"),
                        HasSubstr("stop process " + std::to_string(::getpid()))));
      EXPECT_EQ(fs::file_size(path), before) << "left as it was found";
    }
    Database again(path, Mode::read_write);
    EXPECT_EQ(appending(again, 2), "no error");
    EXPECT_EQ(Archive(again).sample_count(), 2U);
    EXPECT_THAT(rows(path, "SELECT length(x) FROM filler"), ::testing::ElementsAre("40000"));
    EXPECT_THAT(rows(path, "PRAGMA integrity_check"), ::testing::ElementsAre("ok"));
  }
}

TEST(FilesInUse, AFileThatIsCutIsNotWrittenAndItsLogIsKept) {
  for (const std::uintmax_t length :
       {std::uintmax_t{0}, std::uintmax_t{20}, std::uintmax_t{4096}, std::uintmax_t{30'000}}) {
    SCOPED_TRACE("cut to " + std::to_string(length));
    const TemporaryFolder folder;
    const fs::path path = folder / "a.db";
    { const Database made(path, Mode::read_write); }
    {
      Database database(path, Mode::read_write);
      ASSERT_EQ(appending(database, 1), "no error");
      cut_to(path, length);
      EXPECT_THAT(appending(database, 2),
                  AllOf(StartsWith("corrupt: database " + path.string() + " was cut short"),
                        HasSubstr("while it is in use"), HasSubstr("restore a backup")));
    }
    EXPECT_GT(fs::file_size(path.string() + "-wal"), 0U);
    EXPECT_THAT(opening(path), AllOf(StartsWith("corrupt: "), HasSubstr("was cut short")));
    EXPECT_EQ(fs::file_size(path), length) << "left as it was found";
  }
}

// ---- damage that is found when an archive is opened

TEST(DamagedFile, AFileThatHasLostItsEndBesideALogIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db", copy = folder / "copy.db";
  { const Database made(path, Mode::read_write); }
  Database database(path, Mode::read_write);
  ASSERT_EQ(appending(database, 1), "no error");
  const std::string file = read_file(path), log = read_file(path.string() + "-wal");
  for (const std::size_t length : {file.size() - 4096, file.size() - 1, file.size() / 2}) {
    write_file(copy, file.substr(0, length));
    write_file(copy.string() + "-wal", log);
    EXPECT_THAT(opening(copy), AllOf(StartsWith("corrupt: "), HasSubstr("was cut short"),
                                     HasSubstr("its log does not have the rest")));
    EXPECT_EQ(read_file(copy).size(), length);
    EXPECT_EQ(read_file(copy.string() + "-wal"), log);
  }
}

TEST(DamagedFile, AnArchiveThatIsEmptyNowIsNotTakenForANewOne) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  { const Database made(path, Mode::read_write); }
  write_file(path, "");
  EXPECT_THAT(opening(path), AllOf(StartsWith("corrupt: "), HasSubstr("it is empty"),
                                   HasSubstr("remove it to begin again")));
  fs::remove(path);
  EXPECT_EQ(opening(path), "no error");
}

TEST(DamagedFile, ASecondNameOfAFileIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db", other = folder / "b.db";
  { const Database made(path, Mode::read_write); }
  fs::create_hard_link(path, other);
  for (const fs::path& name : {path, other})
    EXPECT_THAT(opening(name), AllOf(StartsWith("cannot_open: "), HasSubstr("2 names"),
                                     HasSubstr("remove the others")));
  fs::remove(other);
  EXPECT_EQ(opening(path), "no error");
}

/// The archive after a few steps of the session, with a log that was not folded into the file.
struct Unclosed {
  std::string file, log;
  std::vector<std::size_t> log_ends;  // length of the log after each step
  std::vector<ExpectedArchive> expected{1};

  explicit Unclosed(std::uint64_t steps) {
    const TemporaryFolder folder;
    const fs::path path = folder / "a.db";
    const fs::path log_path = path.string() + "-wal";
    { const Database made(path, Mode::read_write); }
    Database database(path, Mode::read_write);
    Archive archive(database, session_options);
    for (std::uint64_t number = 0; number < steps; ++number) {
      const Step step = step_at(number);
      if (!step.frames.empty()) archive.append(step.frames);
      expected.push_back(expected.back());
      expected.back().append(step.frames);
      log_ends.push_back(fs::file_size(log_path));
    }
    file = read_file(path);
    log = read_file(log_path);
  }
};

TEST(DamagedLog, AFlippedBitIsNamedOrTakesTheLastCommitAlone) {
  const Unclosed made(5);
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  std::mt19937 random(11);
  int refused = 0, taken = 0;
  for (int i = 0; i < 150; ++i) {
    const std::size_t bit = random() % (made.log.size() * 8);
    SCOPED_TRACE("bit " + std::to_string(bit) + " of " + std::to_string(made.log.size() * 8));
    std::string log = made.log;
    flip_bit(log, bit);
    for (const Durability durability : {Durability::power_cut, Durability::kill}) {
      write_file(path, made.file);
      write_file(path.string() + "-wal", log);
      fs::remove(path.string() + "-shm");
      std::string difference;
      const std::string error = error_of([&] {
        Database database(path, Mode::read_write, durability);
        const Archive archive(database);
        std::uint64_t frames = 0;
        for (const SourceCounts& source : archive.sources()) frames += source.frames;
        std::size_t found = 0;
        while (found + 1 < made.expected.size() && made.expected[found + 1].frames() <= frames)
          ++found;
        difference = made.expected[found].difference(archive);
        if (durability == Durability::power_cut) {
          EXPECT_GE(found, made.expected.size() - 2) << "more than the last commit is gone";
          ++taken;
        }
      });
      EXPECT_EQ(difference, "");
      if (durability == Durability::kill) {
        EXPECT_EQ(error, "no error") << "the end of the log is not promised";
      } else if (error != "no error") {
        EXPECT_THAT(error, AllOf(StartsWith("corrupt: "), HasSubstr("a.db-wal"),
                                 HasSubstr("damaged"), HasSubstr("wal_checkpoint(TRUNCATE)")));
        EXPECT_EQ(read_file(path.string() + "-wal"), log) << "left as it was found";
        ++refused;
      }
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(taken, 5);
}

TEST(DamagedLog, ALogThatIsGoneTakesWhatItHeldAndNothingElse) {
  const Unclosed made(5);
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  write_file(path, made.file);
  Database database(path, Mode::read_write);
  EXPECT_EQ(made.expected.front().difference(Archive(database)), "");
}

// ---- bits that flip in the file

constexpr std::uint64_t steps = 3 * steps_of_cycle;

/// What a program makes of the file: whether all that it reads is `expected`, then whether it can
/// go on writing. "same", "different", or the kind of the error.
std::string outcome_of(const fs::path& path, const ExpectedArchive& expected) {
  ::alarm(10);  // a program that hangs dies of it
  std::string read;
  const std::string error = error_of([&] {
    Database database(path, Mode::read_only);
    read = expected.difference(Archive(database)).empty() ? "same" : "different";
  });
  if (error != "no error") read = error.substr(0, error.find(':'));
  const std::string written = error_of([&] {
    Database database(path, Mode::read_write);
    Archive archive(database, session_options);
    for (std::uint64_t step = steps; step < steps + 5; ++step) archive.append(step_at(step).frames);
    archive.compact();
  });
  return read + ", written: " + written.substr(0, written.find(':'));
}

TEST(FlippedBits, AreNamedOrChangeNothingAndNeverEndTheProgram) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  carry_out_steps(
      path, Durability::power_cut, 0, steps, [](std::uint64_t) {}, [](std::uint64_t) {});
  ExpectedArchive expected;
  for (std::uint64_t step = 0; step < steps; ++step) expected.append(step_at(step).frames);
  const std::string whole = read_file(path);
  std::mt19937 random(5);
  std::map<std::string, int> outcomes;
  for (int i = 0; i < 300; ++i) {
    std::size_t bit = 0;
    do bit = random() % (whole.size() * 8);
    while (whole[bit / 8] == 0);  // most of what is zero is not in use
    SCOPED_TRACE("bit " + std::to_string(bit));
    std::string bytes = whole;
    flip_bit(bytes, bit);
    for (const char* suffix : {"-wal", "-shm"}) fs::remove(path.string() + suffix);
    write_file(path, bytes);
    const bool is_sound = rows(path, "PRAGMA integrity_check") == std::vector<std::string>{"ok"};
    const std::string outcome = in_child([&] { return outcome_of(path, expected); });
    ++outcomes[outcome.substr(0, outcome.find(',')) + (is_sound ? "" : ", unsound")];
    EXPECT_THAT(outcome, Not(AnyOf(HasSubstr("died"), HasSubstr("another"))));
  }
  for (const auto& [outcome, count] : outcomes) RecordProperty(outcome, count);
  EXPECT_GT(outcomes["corrupt"] + outcomes["corrupt, unsound"], 100);
  // In the few rows that index the chunks, numbers and times have no checksum: 'reident verify'
  // compares them with the chunks.
  EXPECT_LT(outcomes["different"], 15);
}

}  // namespace
}  // namespace reident::storage::test::damage_test
