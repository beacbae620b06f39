// The writer of an archive is killed, at every one of its file operations and at random moments;
// what it had reported is there each time.
#include <chrono>
#include <csignal>
#include <map>
#include <random>
#include <unistd.h>

#include <sys/wait.h>

#include "tests/storage/archive/writer_session.hpp"
#include "tests/storage/database/watched_files.hpp"
#include "tests/storage/expected_archive.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::kill_test {
namespace {

namespace fs = std::filesystem;
using Fate = WatchedFiles::Fate;
using Kind = FileOperation::Kind;

/// What a writer was at when it was killed; a letter in the pipe to the test.
enum class Moment : char {
  making = 'm',         // the file and its tables
  appending = 'a',      // within the transaction of a batch, which moves samples into chunks too
  compacting = 'c',     // within a transaction that does so alone
  between_steps = 's',  // two of these
  between = 'b',        // two others
  checkpoint = 'p',     // the log is being folded into the file
  closing = 'x',        // the log is being removed
};

/// Counts the operations of the process, and kills it at one of them.
class Killer {
 public:
  Killer(std::uint64_t operation, bool half_way, int reports)
      : last_(operation), half_way_(half_way), reports_(reports) {}

  void begins(std::uint64_t step) { step_ = step_at(step).kind; }
  Fate operator()(const FileOperation& operation) {
    const bool is_log = operation.path.ends_with("-wal");
    log_exists_ = log_exists_ || is_log;
    if (++count_ != last_) return Fate::happens;
    const char moment = static_cast<char>(moment_of(operation, is_log));
    if (::write(reports_, &moment, 1) != 1) ::_exit(3);
    return half_way_ ? Fate::killed_half_way : Fate::killed_before;
  }
  std::uint64_t count() const { return count_; }

 private:
  Moment moment_of(const FileOperation& operation, bool is_log) const {
    if (!log_exists_) return Moment::making;
    if (operation.kind == Kind::begin || operation.kind == Kind::end)
      return step_ == StepKind::compact ? Moment::between_steps : Moment::between;
    if (!is_log) return Moment::checkpoint;
    if (operation.kind == Kind::remove || operation.kind == Kind::truncate) return Moment::closing;
    return step_ == StepKind::compact ? Moment::compacting : Moment::appending;
  }

  const std::uint64_t last_;
  const bool half_way_;
  const int reports_;
  std::uint64_t count_ = 0;
  StepKind step_ = StepKind::append;
  bool log_exists_ = false;
};

/// A writer in a process of its own that reports a '+' for each step that returned.
class Writer {
 public:
  explicit Writer(const std::function<void(int reports)>& work) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      try {
        work(ends[1]);
      } catch (...) {
        ::_exit(2);
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    reports_ = ends[0];
  }
  ~Writer() { ::close(reports_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// False when no further report came.
  bool wait_for_step() {
    char report = 0;
    if (::read(reports_, &report, 1) != 1) return false;
    if (report == '+')
      ++steps_;
    else
      moment_ = static_cast<Moment>(report);
    return true;
  }
  void kill() { ::kill(process_, SIGKILL); }
  /// Waits for its end; its status as waitpid gives it.
  int end() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    while (wait_for_step()) {
    }
    return status;
  }
  std::uint64_t steps() const { return steps_; }
  std::optional<Moment> moment() const { return moment_; }

 private:
  pid_t process_ = 0;
  int reports_ = -1;
  std::uint64_t steps_ = 0;
  std::optional<Moment> moment_;
};

void report_step(int reports) {
  if (::write(reports, "+", 1) != 1) ::_exit(1);
}

class KillTest : public ::testing::Test {
 protected:
  /// The archive as it is after `steps` steps.
  const ExpectedArchive& expected(std::uint64_t steps) {
    while (expected_.size() <= steps) {
      const Step step = step_at(expected_.size() - 1);
      expected_.push_back(expected_.back());
      expected_.back().append(step.frames);
    }
    return expected_[steps];
  }

  /// Compares the file with what was reported and returns how many steps are in it.
  std::uint64_t compare(const fs::path& path, std::uint64_t reported) {
    std::uint64_t steps = reported;
    {
      Database database(path, Database::Mode::read_write);
      const Archive archive(database);
      std::string difference = expected(reported).difference(archive);
      if (!difference.empty() && expected(reported + 1).difference(archive).empty()) {
        difference.clear();
        ++steps;  // the one on its way is there as a whole
      }
      EXPECT_EQ(difference, "") << "after " << reported << " reported steps";
    }
    EXPECT_EQ(rows(path, "PRAGMA integrity_check"), std::vector<std::string>{"ok"});
    return steps;
  }

 private:
  std::vector<ExpectedArchive> expected_{1};
};

TEST_F(KillTest, NothingReportedIsLostWhereverAmongItsFileOperationsTheWriterIsKilled) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.db";
  constexpr std::uint64_t steps = 2 * steps_of_cycle;
  std::map<Moment, int> kills;
  bool has_ended = false;
  for (std::uint64_t operation = 1; !has_ended && !HasFailure(); ++operation) {
    SCOPED_TRACE("killed at file operation " + std::to_string(operation));
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(path.string() + suffix);
    Writer writer([&](int reports) {
      Killer killer(operation, operation % 2 == 0, reports);
      const WatchedFiles watched(std::ref(killer));
      carry_out_steps(
          path, Durability::power_cut, 0, steps, [&](std::uint64_t step) { killer.begins(step); },
          [&](std::uint64_t) { report_step(reports); });
    });
    const int status = writer.end();
    has_ended = WIFEXITED(status);
    if (has_ended) {
      ASSERT_EQ(WEXITSTATUS(status), 0) << "the writer failed by itself";
      ASSERT_EQ(writer.steps(), steps);
    } else {
      ASSERT_TRUE(writer.moment()) << "the writer died by itself of " << WTERMSIG(status);
      ++kills[*writer.moment()];
    }
    const std::uint64_t found = compare(path, writer.steps());
    if (operation % 5 != 0) continue;
    carry_out_steps(
        path, Durability::power_cut, found, found + steps_of_cycle, [](std::uint64_t) {},
        [](std::uint64_t) {});
    compare(path, found + steps_of_cycle);
  }
  int sum = 0;
  for (const auto& [moment, count] : kills) {
    RecordProperty(std::string("kills_") + static_cast<char>(moment), count);
    sum += count;
  }
  RecordProperty("kills", sum);
  EXPECT_GT(sum, 200);
  for (const Moment moment :
       {Moment::making, Moment::appending, Moment::compacting, Moment::between_steps,
        Moment::between, Moment::checkpoint, Moment::closing})
    EXPECT_GT(kills[moment], 0) << "never killed at " << static_cast<char>(moment);
}

TEST_F(KillTest, NothingReportedIsLostWhenTheWriterIsKilledAtRandomMoments) {
  const TemporaryFolder folder(fs::temp_directory_path());  // on a disk, where a flush takes time
  std::mt19937 random(20170717);
  constexpr int rounds = 200, rounds_of_file = 25;
  std::uint64_t stored = 0;
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const fs::path path = folder / ("a" + std::to_string(round / rounds_of_file) + ".db");
    if (round % rounds_of_file == 0) stored = 0;
    Writer writer([&](int reports) {
      carry_out_steps(
          path, round % 2 == 0 ? Durability::power_cut : Durability::kill, stored, ~0ULL,
          [](std::uint64_t) {}, [&](std::uint64_t) { report_step(reports); });
    });
    const std::uint64_t until = random() % 15;
    while (writer.steps() < until && writer.wait_for_step()) {
    }
    const auto moment =
        std::chrono::steady_clock::now() + std::chrono::microseconds(random() % 6000);
    while (std::chrono::steady_clock::now() < moment) {
    }
    writer.kill();
    const int status = writer.end();
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself: " << status;
    stored = compare(path, stored + writer.steps());
  }
  EXPECT_GT(stored, 50U);
}

}  // namespace
}  // namespace reident::storage::test::kill_test
