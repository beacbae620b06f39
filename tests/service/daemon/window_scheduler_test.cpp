#include "service/daemon/window_scheduler.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace reident::window_scheduler_test {
namespace {

using Job = WindowScheduler::Job;

// One equipment; windows of 30 that end at multiples of 10; a settle time of 5.
class Scheduler : public testing::Test {
 protected:
  WindowScheduler scheduler{{{.window = 30, .slide = 10}}, 5};

  /// Samples at each of [begin, end), all stored at `now`.
  void telemetry(storage::Time begin, storage::Time end, storage::Time now) {
    for (auto time = begin; time < end; ++time) {
      scheduler.touched(0, time, now);
      scheduler.reached(0, time);
    }
  }
  Job complete(storage::Time now) {
    const auto job = scheduler.next(now);
    EXPECT_TRUE(job.has_value());
    scheduler.finished(job.value_or(Job{}), true, now);
    return job.value_or(Job{});
  }
};

TEST_F(Scheduler, GivesAWindowOnceTelemetryHasReachedItsEndAndNothingFellIntoItForTheSettleTime) {
  telemetry(0, 10, 100);
  EXPECT_FALSE(scheduler.next(200)) << "the sample at 9 does not reach the end at 10";
  telemetry(10, 11, 110);
  EXPECT_EQ(scheduler.next(200), (Job{0, {-20, 10}, "slide"}));
}

TEST_F(Scheduler, AWindowThatAnotherServiceTriedIsDueAgainForLateTelemetryAlone) {
  telemetry(0, 21, 100);
  scheduler.tried_elsewhere(0, {-20, 10});
  EXPECT_EQ(scheduler.pending(), 1U);
  EXPECT_EQ(complete(200).window, (storage::TimeRange{-10, 20}));
  EXPECT_FALSE(scheduler.next(200));
  scheduler.touched(0, 5, 300);
  EXPECT_EQ(scheduler.next(400), (Job{0, {-20, 10}, "late telemetry"}));
}

TEST_F(Scheduler, WaitsForStragglers) {
  telemetry(0, 11, 100);
  EXPECT_FALSE(scheduler.next(104));
  EXPECT_EQ(scheduler.next_due(), 105);
  EXPECT_TRUE(scheduler.next(105));
}

TEST_F(Scheduler, LeavesOutWindowsWhoseLastSlideIsEmpty) {
  telemetry(0, 11, 100);
  telemetry(95, 101, 100);
  EXPECT_EQ(complete(200).window, (storage::TimeRange{-20, 10}));
  EXPECT_EQ(complete(200).window, (storage::TimeRange{-10, 20})) << "holds the sample at 10";
  EXPECT_EQ(complete(200).window, (storage::TimeRange{70, 100}));
  EXPECT_FALSE(scheduler.next(200));
}

TEST_F(Scheduler, RunsOneWindowOfAnEquipmentAtATimeOldestFirst) {
  telemetry(0, 31, 100);
  const auto first = scheduler.next(200);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->window.end, 10);
  EXPECT_FALSE(scheduler.next(200)) << "the first still runs";
  scheduler.finished(*first, true, 200);
  EXPECT_EQ(complete(200).window.end, 20);
}

TEST_F(Scheduler, LooksAgainAtTriedWindowsThatLateTelemetryTouched) {
  telemetry(0, 41, 100);
  for (int i = 0; i < 4; ++i) complete(200);
  scheduler.touched(0, 15, 300);
  EXPECT_FALSE(scheduler.next(304));
  EXPECT_EQ(complete(305), (Job{0, {-10, 20}, "late telemetry"}));
  EXPECT_EQ(complete(305), (Job{0, {0, 30}, "late telemetry"}));
  EXPECT_EQ(complete(305), (Job{0, {10, 40}, "late telemetry"}));
  EXPECT_FALSE(scheduler.next(400));
}

TEST_F(Scheduler, DoesNotLetAWindowThatKeepsReceivingLateTelemetryHoldUpTheNext) {
  telemetry(0, 21, 100);
  scheduler.touched(0, 3, 199);
  EXPECT_EQ(scheduler.next(200)->window.end, 20);
}

TEST_F(Scheduler, TriesAWindowAgainThatWasNotCompleted) {
  telemetry(0, 11, 100);
  const auto job = scheduler.next(200);
  scheduler.finished(*job, false, 200);
  EXPECT_FALSE(scheduler.next(204));
  EXPECT_EQ(scheduler.next(205), job);
}

TEST_F(Scheduler, KnowsWhatAnEarlierRunTried) {
  scheduler.tried_before(0, {-20, 10});
  scheduler.tried_before(0, {-10, 20});
  scheduler.tried_before(0, {4, 24});
  scheduler.tried_before(0, {6, 26});
  scheduler.reached(0, 30);
  EXPECT_FALSE(scheduler.next(200));
  scheduler.touched(0, 5, 200);
  EXPECT_EQ(complete(300), (Job{0, {-20, 10}, "late telemetry"}));
  EXPECT_EQ(complete(300), (Job{0, {-10, 20}, "late telemetry"}));
  EXPECT_EQ(complete(300), (Job{0, {4, 24}, "late telemetry"}));
  EXPECT_FALSE(scheduler.next(300));
}

TEST_F(Scheduler, LooksAgainAtAWindowInWhichTelemetryLandedWhileItRan) {
  telemetry(0, 31, 100);
  complete(200);
  complete(200);
  const auto running = scheduler.next(200);
  ASSERT_EQ(running->window, (storage::TimeRange{0, 30}));
  scheduler.touched(0, 1, 201);
  scheduler.finished(*running, true, 202);
  EXPECT_EQ(complete(300), (Job{0, {-20, 10}, "late telemetry"}));
  EXPECT_EQ(complete(300), (Job{0, {-10, 20}, "late telemetry"}));
  EXPECT_EQ(complete(300), (Job{0, {0, 30}, "late telemetry"}));
}

TEST_F(Scheduler, GivesAWindowThatWasAskedForAsSoonAsTelemetryHasReachedIt) {
  telemetry(0, 15, 100);
  complete(200);
  scheduler.ask(0, 17, "drift", 200);
  EXPECT_FALSE(scheduler.next(200));
  scheduler.reached(0, 17);
  EXPECT_EQ(scheduler.next_due(), 200);
  EXPECT_EQ(complete(200), (Job{0, {-13, 17}, "drift"}));
  EXPECT_FALSE(scheduler.next(300)) << "the window that slides ends at 20";
}

TEST_F(Scheduler, GivesAWindowThatWasAskedForWithItsBegin) {
  telemetry(0, 15, 100);
  complete(200);
  scheduler.ask(0, 14, "drift", 200, 2);
  const auto job = scheduler.next(200);
  EXPECT_EQ(job, (Job{0, {2, 14}, "drift"}));
  scheduler.finished(*job, false, 200);
  EXPECT_EQ(complete(300), (Job{0, {2, 14}, "drift"})) << "it was not completed";
  scheduler.touched(0, 3, 300);
  EXPECT_EQ(complete(400), (Job{0, {-20, 10}, "late telemetry"}));
  EXPECT_EQ(complete(400), (Job{0, {2, 14}, "late telemetry"}));
  scheduler.touched(0, 1, 500);
  EXPECT_EQ(complete(600), (Job{0, {-20, 10}, "late telemetry"}));
  EXPECT_FALSE(scheduler.next(600)) << "it does not hold the sample at 1";
}

TEST_F(Scheduler, KeepsWhatWasAskedForWhereItEndsAsOneThatSlidesAndLetsItSettle) {
  telemetry(0, 15, 100);
  complete(200);
  scheduler.ask(0, 20, "drift", 200, 12);
  telemetry(15, 22, 300);
  scheduler.touched(0, 11, 301);
  scheduler.touched(0, 13, 302);
  EXPECT_FALSE(scheduler.next(306));
  EXPECT_EQ(complete(307), (Job{0, {12, 20}, "drift"}));
}

TEST_F(Scheduler, KeepsTheCauseOfAWindowThatWasNotCompleted) {
  telemetry(0, 8, 100);
  scheduler.ask(0, 7, "asked for by ana", 100);
  const auto job = scheduler.next(100);
  ASSERT_TRUE(job);
  scheduler.finished(*job, false, 200);
  EXPECT_EQ(complete(205), (Job{0, {-23, 7}, "asked for by ana"}));
}

TEST_F(Scheduler, CountsWhatIsPendingAndWhere) {
  EXPECT_EQ(scheduler.pending(), 0U);
  telemetry(0, 21, 100);
  EXPECT_EQ(scheduler.pending(), 2U);
  const auto running = scheduler.next(200);
  EXPECT_EQ(scheduler.pending(), 2U);
  EXPECT_TRUE(scheduler.pending_within(0, {-15, -14})) << "the running one counts";
  scheduler.finished(*running, true, 200);
  EXPECT_FALSE(scheduler.pending_within(0, {-15, -14}));
  EXPECT_TRUE(scheduler.pending_within(0, {19, 20}));
}

TEST_F(Scheduler, SurvivesTimesFromTheEndsOfTheScale) {
  for (const auto time :
       {std::numeric_limits<storage::Time>::min(), std::numeric_limits<storage::Time>::max()}) {
    scheduler.touched(0, time, 100);
    EXPECT_FALSE(scheduler.next(std::numeric_limits<storage::Time>::max() / 2));
  }
  scheduler.reached(0, std::numeric_limits<storage::Time>::min() + 1);
  constexpr storage::Time century = 3'155'760'000'000'000'000;
  EXPECT_GT(scheduler.reached(0), std::numeric_limits<storage::Time>::min() + century / 2)
      << "whoever takes a settle time off it stays in the scale";
}

TEST(SchedulerOfSeveral, GivesTheOldestWindowOfAllEquipmentFirst) {
  WindowScheduler scheduler({{.window = 20, .slide = 10}, {.window = 20, .slide = 5}}, 0);
  for (std::size_t equipment = 0; equipment < 2; ++equipment) {
    scheduler.touched(equipment, 1, 0);
    scheduler.reached(equipment, 100);
  }
  EXPECT_EQ(scheduler.next(0), (Job{1, {-15, 5}, "slide"}));
  EXPECT_EQ(scheduler.next(0), (Job{0, {-10, 10}, "slide"}));
}

TEST(SchedulerOfSeveral, TheBacklogOfOneHoldsUpNoOther) {
  WindowScheduler scheduler({{.window = 20, .slide = 10}, {.window = 20, .slide = 10}}, 0);
  for (storage::Time time = 0; time < 1000; time += 10) scheduler.touched(0, time, 0);
  scheduler.touched(1, 900, 0);
  for (std::size_t equipment = 0; equipment < 2; ++equipment) scheduler.reached(equipment, 1000);
  const auto tried = [&](const std::optional<Job>& job) {
    EXPECT_TRUE(job);
    if (!job) return storage::Time{-1};
    scheduler.finished(*job, true, 0);
    return job->window.end;
  };
  EXPECT_EQ(tried(scheduler.next(0)), 10);
  EXPECT_EQ(tried(scheduler.next(0)), 910) << "the other one's";
  EXPECT_EQ(tried(scheduler.next(0)), 20);
  scheduler.ask(1, 1000, "operator", 0);
  EXPECT_EQ(tried(scheduler.next(0)), 1000);
  EXPECT_EQ(tried(scheduler.next(0)), 30);
}

}  // namespace
}  // namespace reident::window_scheduler_test
