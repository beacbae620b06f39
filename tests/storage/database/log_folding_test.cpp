// How long the log grows next to readers.
#include "storage/database/log_folding.hpp"

#include <atomic>
#include <thread>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::log_folding_test {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t mebibyte = std::uintmax_t{1} << 20;

/// A snapshot that is held for as long as this exists.
class Snapshot {
 public:
  explicit Snapshot(const fs::path& database) {
    sqlite3_open_v2(database.c_str(), &handle_, SQLITE_OPEN_READONLY, nullptr);
    sqlite3_busy_timeout(handle_, sqlite::busy_timeout_ms);
    EXPECT_EQ(
        sqlite3_exec(handle_, "BEGIN; SELECT count(*) FROM attempt", nullptr, nullptr, nullptr),
        SQLITE_OK);
  }
  ~Snapshot() { sqlite3_close(handle_); }
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

 private:
  sqlite3* handle_ = nullptr;
};

/// Two threads of which one always reads: each ends when the other one has begun.
class OverlappingReaders {
 public:
  explicit OverlappingReaders(const fs::path& database) {
    for (std::thread& thread : threads_) thread = std::thread([this, database] { run(database); });
    while (begun_ == 0) std::this_thread::yield();
  }
  ~OverlappingReaders() {
    stopping_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  std::uint64_t begun() const { return begun_; }

 private:
  void run(const fs::path& database) {
    while (!stopping_) {
      const Snapshot snapshot(database);
      const std::uint64_t mine = ++begun_;
      while (begun_ == mine && !stopping_) std::this_thread::yield();
    }
  }
  std::atomic<std::uint64_t> begun_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread threads_[2];
};

void write_mebibytes(Database& database, int count) {
  NewAttempt attempt;
  attempt.spacecraft = "CB4";
  attempt.equipment = "BDR";
  attempt.evidence_json = std::string(mebibyte, ' ');
  for (int i = 0; i < count; ++i) Registry(database).record(attempt);
}

TEST(Log, StaysShortWhileReadersOverlapWithoutEnd) {
  const TemporaryFolder folder;
  Database(folder / "a.db", Database::Mode::read_write);
  sqlite3* writer = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "a.db").c_str(), &writer), SQLITE_OK);
  std::uintmax_t longest = 0;
  {
    const sqlite::LogFolding folding(writer,
                                     120'000);  // longer than a loaded machine stops a thread
    const OverlappingReaders readers(folder / "a.db");
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(sqlite3_exec(writer,
                             "CREATE TABLE IF NOT EXISTS large (content BLOB);"
                             "INSERT INTO large VALUES (zeroblob(1048576)); DELETE FROM large",
                             nullptr, nullptr, nullptr),
                SQLITE_OK);
      longest = std::max(longest, fs::file_size(folder / "a.db-wal"));
    }
    EXPECT_GT(readers.begun(), 10U);
  }
  sqlite3_close(writer);
  EXPECT_GE(longest, 32 * mebibyte);
  EXPECT_LE(longest, 40 * mebibyte);
}

TEST(Log, GrowsWhileAReaderStaysAndIsBegunAgainBehindIt) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  {
    const Snapshot snapshot(folder / "a.db");
    write_mebibytes(database, 50);  // the writer waits once
    EXPECT_GT(fs::file_size(folder / "a.db-wal"), 50 * mebibyte);
  }
  write_mebibytes(database, 50);
  EXPECT_LT(fs::file_size(folder / "a.db-wal"), 64 * mebibyte);
}

}  // namespace
}  // namespace reident::storage::test::log_folding_test
