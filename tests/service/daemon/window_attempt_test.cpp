#include "service/daemon/window_attempt.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "service/operations/backfill.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::window_attempt_test {
namespace {

class WindowAttempt : public DaemonTest {
 protected:
  explicit WindowAttempt(Duration jitter = 0) {
    auto frames = telemetry(day, 1801);
    for (std::size_t i = 0; i < frames.size(); ++i)
      frames[i].generation_time += (static_cast<Duration>(i % 7) - 3) * jitter / 3;
    archive.describe(descriptors());
    archive.append(frames);
  }
  RecordedAttempt attempt(storage::TimeRange window) { return *try_window(window); }
  /// `before` runs before anything is written.
  std::optional<RecordedAttempt> try_window(
      storage::TimeRange window, const std::function<void()>& before = [] {}) {
    const WindowFeed::Job job{{0, window, "slide"}, &spacecraft, &equipment, {}};
    WindowCache kept = window_cache_of(spacecraft, equipment);
    return attempt_window(job, archive, registry, kept,
                          {{[&](const auto& task) {
                              before();
                              task(registry, archive);
                            },
                            [] { return day; }, [] { return false; }},
                           "digest",
                           {},
                           &leagues});
  }

  const Config all = config();
  const std::string& spacecraft = all.spacecraft[0].name;
  const EquipmentConfig& equipment = all.spacecraft[0].equipment[0];
  WindowFeed feed{all, [] { return day; }, [] { return day; }};
  LeagueWatch leagues{all, feed};
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(WindowAttempt, TriesNothingThatLiesBeforeTheChampionsWindow) {
  const storage::TimeRange drift{day + 10 * minute, day + 18 * minute};
  ASSERT_EQ(attempt(drift).result.attempt.outcome, "challenger");
  ASSERT_TRUE(registry.champion("SAT", "PLANT")) << "its validation part is enough for the first";
  EXPECT_EQ(attempt({day + 10 * minute, day + 20 * minute}).result.attempt.window,
            (storage::TimeRange{day + 10 * minute, day + 20 * minute}));
  EXPECT_EQ(attempt({day + 9 * minute, day + 19 * minute}).result.attempt.window,
            (storage::TimeRange{day + 10 * minute, day + 19 * minute}));
  EXPECT_EQ(attempt({day, day + 10 * minute}).result.attempt.window,
            (storage::TimeRange{day, day + 10 * minute}))
      << "an older one";
}

TEST_F(WindowAttempt, IsNotRecordedWithoutAModelEitherOnceTheDecisionStateIsAnotherOne) {
  const storage::TimeRange empty{day + 60 * minute, day + 70 * minute};
  int writes = 0;
  const auto hold = [&] {
    if (++writes == 2) registry.put_on_hold("SAT", "PLANT", {"ana", "rehearsal", 1});
  };
  EXPECT_FALSE(try_window(empty, hold));
  EXPECT_EQ(writes, 2) << "the seal and the record";
  EXPECT_TRUE(registry.attempts({}).empty());
  EXPECT_EQ(attempt(empty).result.attempt.outcome, "low_coverage");
}

class WindowAttemptOnTimesThatJitter : public WindowAttempt {
 protected:
  WindowAttemptOnTimesThatJitter() : WindowAttempt(45 * second / 1000) {}
};

TEST_F(WindowAttemptOnTimesThatJitter, PutsItsTicksWhereBackfillDoes) {
  const auto first = attempt({day, day + 10 * minute});
  ASSERT_TRUE(registry.champion("SAT", "PLANT"));
  EXPECT_EQ(first.result.candidate->phase_ns, 100 * second / 1000);
  const auto next = attempt({day + 5 * minute, day + 15 * minute});
  EXPECT_TRUE(std::isfinite(next.result.champion_mrse_percent)) << "it asks for the same telemetry";

  Config later = all;
  later.database = path();
  storage::Database other(path().parent_path() / "other.db", storage::Database::Mode::read_write);
  WorkerPool workers(1);
  const BackfillProgress progress = backfill(
      other, later, {{}, {}, {day + 10 * minute, day + 16 * minute}}, workers,
      [](storage::Time) { return day; }, [](const BackfillProgress&) { return true; });
  EXPECT_EQ(progress.done, 2U);
  for (const std::int64_t number : {1, 2}) {
    const auto here = registry.version("SAT", "PLANT", number);
    const auto there = storage::Registry(other).version("SAT", "PLANT", number);
    ASSERT_TRUE(there) << number;
    EXPECT_EQ(there->digest, here->digest) << number;
  }
}

}  // namespace
}  // namespace reident::test::window_attempt_test
