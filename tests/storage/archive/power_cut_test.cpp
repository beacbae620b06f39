// The power fails: what was not flushed to the disk is there in part, torn, or not at all.
#include <random>

#include "tests/storage/archive/unsafe_disk.hpp"
#include "tests/storage/archive/writer_session.hpp"
#include "tests/storage/database/watched_files.hpp"
#include "tests/storage/expected_archive.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::power_cut_test {
namespace {

namespace fs = std::filesystem;
using Kind = FileOperation::Kind;

/// What a writer asked of its files, and how many operations had been asked when each step
/// returned.
struct Recording {
  std::vector<FileOperation> operations;
  std::vector<std::size_t> step_ends;
};

Recording record(Durability durability, std::uint64_t steps) {
  const TemporaryFolder folder;
  Recording recording;
  const WatchedFiles watched([&](const FileOperation& operation) {
    recording.operations.push_back(operation);
    return WatchedFiles::Fate::happens;
  });
  carry_out_steps(
      folder / "a.db", durability, 0, steps, [](std::uint64_t) {},
      [&](std::uint64_t) { recording.step_ends.push_back(recording.operations.size()); });
  return recording;
}

std::vector<ExpectedArchive> expected_after_each_step(std::uint64_t steps) {
  std::vector<ExpectedArchive> expected(1);
  for (std::uint64_t number = 0; number < steps; ++number) {
    expected.push_back(expected.back());
    expected.back().append(step_at(number).frames);
  }
  return expected;
}

/// What a cut at one moment left.
struct Outcome {
  std::uint64_t returned = 0;  // steps that had returned
  std::uint64_t found = 0;     // steps that are in the file
  std::size_t unsynced = 0;    // operations that the cut could take
};

/// Cuts the power `cuts` times at moments spread over the recording. Each time the file must be
/// sound and hold the steps up to one of them, as a whole.
std::vector<Outcome> cut_often(const Recording& recording, Durability durability, int cuts) {
  const TemporaryFolder folder;
  const std::vector<ExpectedArchive> expected =
      expected_after_each_step(recording.step_ends.size());
  std::mt19937 random(7);
  std::vector<std::size_t> moments;
  for (int i = 0; i < cuts; ++i) moments.push_back(random() % (recording.operations.size() + 1));
  std::sort(moments.begin(), moments.end());
  UnsafeDisk disk;
  std::size_t applied = 0;
  std::vector<Outcome> outcomes;
  for (const std::size_t moment : moments) {
    SCOPED_TRACE("cut before file operation " + std::to_string(moment));
    for (; applied < moment; ++applied) disk.apply(recording.operations[applied]);
    disk.cut_power(folder / "cut", random);
    const auto returned = static_cast<std::uint64_t>(
        std::upper_bound(recording.step_ends.begin(), recording.step_ends.end(), moment) -
        recording.step_ends.begin());
    const fs::path path = folder / "cut" / "a.db";
    const std::string error = error_of([&] {
      Database database(path, Database::Mode::read_write, durability);
      const Archive archive(database);
      std::uint64_t frames = 0;
      for (const SourceCounts& source : archive.sources()) frames += source.frames;
      std::uint64_t found = 0;
      while (found + 1 < expected.size() && expected[found + 1].frames() <= frames) ++found;
      EXPECT_EQ(expected[found].difference(archive), "") << "after " << found << " steps";
      outcomes.push_back({returned, found, disk.unsynced()});
    });
    EXPECT_EQ(error, "no error");
    EXPECT_EQ(rows(path, "PRAGMA integrity_check"), std::vector<std::string>{"ok"});
    if (::testing::Test::HasFailure()) break;
  }
  return outcomes;
}

constexpr std::uint64_t steps = 4 * steps_of_cycle;

TEST(PowerCut, TakesNothingThatReturned) {
  const Recording recording = record(Durability::power_cut, steps);
  std::size_t could_take_something = 0;
  for (const Outcome& outcome : cut_often(recording, Durability::power_cut, 400)) {
    EXPECT_GE(outcome.found, outcome.returned) << "what had returned is lost";
    EXPECT_LE(outcome.found, outcome.returned + 2) << "more than the step on its way";
    could_take_something += outcome.unsynced > 0 ? 1 : 0;
  }
  EXPECT_GT(could_take_something, 200U);
}

TEST(PowerCut, TakesTheLastCommitsAloneWhereTheyNeedNotWaitForTheDisk) {
  const Recording recording = record(Durability::kill, steps);
  std::size_t took_something = 0;
  for (const Outcome& outcome : cut_often(recording, Durability::kill, 400)) {
    // What was there when the log was folded into the file last stays.
    std::uint64_t folded = 0;
    for (std::uint64_t step = 0; step < outcome.returned; ++step)
      if (const StepKind kind = step_at(step).kind;
          kind == StepKind::checkpoint || kind == StepKind::reopen)
        folded = step + 1;
    EXPECT_GE(outcome.found, folded) << "more is lost than the log held";
    EXPECT_LE(outcome.found, outcome.returned + 2);
    took_something += outcome.found < outcome.returned ? 1 : 0;
  }
  EXPECT_GT(took_something, 20U) << "the test takes nothing that was not flushed";
}

}  // namespace
}  // namespace reident::storage::test::power_cut_test
