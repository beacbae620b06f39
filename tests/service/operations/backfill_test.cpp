#include "service/operations/backfill.hpp"

#include <map>

#include <gtest/gtest.h>

#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::backfill_test {
namespace {

TEST_F(DaemonTest, BackfillReachesBackOverNoChampionsBegin) {
  storage::Database database = open();
  storage::Archive archive(database);
  storage::Registry registry(database);
  archive.describe(descriptors());
  archive.append(telemetry(day, 1801));
  WindowCache kept = window_cache_of("SAT", plant());
  const RefreshResult drift =
      refresh(archive, registry,
              {"SAT", plant(), {day + 12 * minute, day + 19 * minute}, "drift", "digest"}, kept, {},
              [] { return false; });
  registry.record(drift.attempt, drift.version, {storage::DecisionKind::approve, "gate", "good"});

  Config all = config();
  all.database = path();
  WorkerPool workers(2);
  const BackfillProgress progress = backfill(
      database, all, {{}, {}, {day + 10 * minute, day + 30 * minute}}, workers,
      [](storage::Time) { return day; }, [](const BackfillProgress&) { return true; });
  EXPECT_EQ(progress.done, 5U);
  std::map<storage::Time, storage::Time> windows;  // begin by end
  for (const storage::Attempt& attempt : registry.attempts({}))
    windows[attempt.window.end] = attempt.window.begin;
  EXPECT_EQ(windows[day + 15 * minute], day + 5 * minute) << "older than the champion";
  EXPECT_EQ(windows[day + 20 * minute], day + 12 * minute);
  EXPECT_EQ(windows[day + 25 * minute], day + 15 * minute);
}

}  // namespace
}  // namespace reident::test::backfill_test
