#include "service/support/parallel.hpp"

#include <atomic>
#include <latch>
#include <numeric>
#include <sched.h>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace reident::parallel_test {
namespace {

class WorkerPools : public testing::TestWithParam<std::size_t> {
 protected:
  WorkerPool pool_{GetParam()};
};

TEST_P(WorkerPools, RunEachTaskOnceAndReturnWhenAllAreDone) {
  for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
    std::vector<int> runs(count);  // not atomic: a task that outlived the call would race
    pool_.for_each(count, [&](std::size_t task) { ++runs[task]; });
    EXPECT_THAT(runs, testing::Each(1)) << count;
  }
}

TEST_P(WorkerPools, RethrowTheExceptionThatALoopWouldHaveMet) {
  std::vector<int> runs(1000);
  try {
    pool_.for_each(runs.size(), [&](std::size_t task) {
      ++runs[task];
      if (task == 3 || task >= 5) throw std::runtime_error(std::to_string(task));
    });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "3");
  }
  EXPECT_LT(std::accumulate(runs.begin(), runs.end(), 0), 1000) << "the rest did not begin";
  std::atomic<int> after = 0;
  pool_.for_each(10, [&](std::size_t) { ++after; });
  EXPECT_EQ(after, 10);
}

TEST_P(WorkerPools, EndTheTasksThatHadBegunBeforeTheyRethrow) {
  std::atomic<int> running = 0;
  EXPECT_THROW(pool_.for_each(100,
                              [&](std::size_t task) {
                                ++running;
                                std::this_thread::yield();
                                --running;
                                if (task == 0) throw std::runtime_error("first");
                              }),
               std::runtime_error);
  EXPECT_EQ(running, 0);
}

TEST_P(WorkerPools, TakeCallsOfTheirOwnTasks) {
  std::atomic<int> runs = 0;
  pool_.for_each(7, [&](std::size_t) {
    pool_.for_each(5, [&](std::size_t) { pool_.for_each(3, [&](std::size_t) { ++runs; }); });
  });
  EXPECT_EQ(runs, 7 * 5 * 3);
}

TEST_P(WorkerPools, AreSharedBySeveralCallers) {
  constexpr std::size_t callers = 4, calls = 200, tasks = 9;
  std::vector<std::size_t> sums(callers);
  std::vector<std::thread> threads;
  for (std::size_t& sum : sums) {
    threads.emplace_back([this, &sum] {
      for (std::size_t call = 0; call < calls; ++call) {
        std::vector<std::size_t> results(tasks);
        pool_.for_each(tasks, [&](std::size_t task) { results[task] = task; });
        sum += std::accumulate(results.begin(), results.end(), std::size_t{0});
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(sums, testing::Each(calls * tasks * (tasks - 1) / 2));
}

TEST_P(WorkerPools, GiveAnExceptionToItsOwnCallerAlone) {
  std::thread fails([this] {
    for (int call = 0; call < 100; ++call)
      EXPECT_THROW(pool_.for_each(4, [](std::size_t) { throw std::runtime_error("no"); }),
                   std::runtime_error);
  });
  for (int call = 0; call < 100; ++call)
    EXPECT_NO_THROW(pool_.for_each(4, [](std::size_t) { std::this_thread::yield(); }));
  fails.join();
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkerPools, testing::Values(1, 2, 5));

TEST(WorkerPool, RunsTasksAtTheSameTimeOnAsManyThreadsAsItWasAskedFor) {
  WorkerPool pool(4);
  std::latch all_four(4);  // reached together, or never
  pool.for_each(4, [&](std::size_t) { all_four.arrive_and_wait(); });
}

TEST(WorkerPool, OfOneThreadRunsTasksInOrderOnTheCallersOwn) {
  WorkerPool pool(1);
  std::vector<std::size_t> order;
  pool.for_each(4, [&, caller = std::this_thread::get_id()](std::size_t task) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(task);
  });
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3));
}

TEST(UsableCores, AreThoseThatTheAffinityLeaves) {
  EXPECT_GE(usable_cores(), 1U);
  std::thread([] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usable_cores(), 1U);
  }).join();
}

}  // namespace
}  // namespace reident::parallel_test
