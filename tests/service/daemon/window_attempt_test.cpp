#include "service/daemon/window_attempt.hpp"

#include <gtest/gtest.h>

#include "tests/service/daemon/daemon_fixture.hpp"

namespace reident::test {
namespace {

class WindowAttempt : public DaemonTest {
 protected:
  WindowAttempt() {
    archive.describe(descriptors());
    archive.append(telemetry(day, 1801));
  }
  RecordedAttempt attempt(storage::TimeRange window) {
    const WindowFeed::Job job{{0, window, "slide"}, &spacecraft, &equipment, {}};
    KeptWindow kept = kept_window_of(spacecraft, equipment);
    return attempt_window(job, archive, registry, kept,
                          {"digest",
                           [this](const auto& task) { task(registry, archive); },
                           [] { return day; },
                           {},
                           [] { return false; }})
        .value();
  }

  const std::string spacecraft = "SAT";
  const EquipmentConfig equipment = plant();
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(WindowAttempt, TriesNothingThatLiesBeforeTheChampionsWindow) {
  const storage::TimeRange drift{day + 10 * minute, day + 18 * minute};
  ASSERT_EQ(attempt(drift).result.attempt.outcome, "approved");
  EXPECT_EQ(attempt({day + 10 * minute, day + 20 * minute}).result.attempt.window,
            (storage::TimeRange{day + 10 * minute, day + 20 * minute}));
  EXPECT_EQ(attempt({day + 9 * minute, day + 19 * minute}).result.attempt.window,
            (storage::TimeRange{day + 10 * minute, day + 19 * minute}));
  EXPECT_EQ(attempt({day, day + 10 * minute}).result.attempt.window,
            (storage::TimeRange{day, day + 10 * minute}))
      << "an older one";
}

}  // namespace
}  // namespace reident::test
