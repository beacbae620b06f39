#include "service/daemon/bounded_queue.hpp"

#include <numeric>
#include <thread>

#include <gtest/gtest.h>

namespace reident {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, KeepsTheOrderAndGivesAtMostWhatIsAskedFor) {
  BoundedQueue<int> queue(8);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(queue.push(std::move(i)));
  std::vector<int> out;
  EXPECT_EQ(queue.pop(out, 3, 0ns), 3U);
  EXPECT_EQ(queue.pop(out, 3, 0ns), 2U);
  EXPECT_EQ(out, (std::vector{0, 1, 2, 3, 4}));
}

TEST(BoundedQueue, HoldsTheProducerBackAndCountsTheWaits) {
  BoundedQueue<int> queue(4);
  constexpr int count = 1000;
  std::thread producer([&] {
    for (int i = 0; i < count; ++i) queue.push(int{i});
    queue.close();
  });
  std::vector<int> out;
  while (!queue.drained()) {
    EXPECT_LE(queue.size(), 4U);
    queue.pop(out, 3, 10s);
  }
  producer.join();
  std::vector<int> expected(count);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(out, expected);
  EXPECT_GT(queue.waits(), 0U);
}

TEST(BoundedQueue, TakesNothingMoreOnceItIsClosedButGivesWhatItHas) {
  BoundedQueue<int> queue(4);
  queue.push(1);
  queue.close();
  EXPECT_FALSE(queue.push(2));
  EXPECT_FALSE(queue.drained());
  std::vector<int> out;
  EXPECT_EQ(queue.pop(out, 9, 10s), 1U);
  EXPECT_TRUE(queue.drained());
}

TEST(BoundedQueue, ReleasesAProducerThatWaitsWhenItIsClosed) {
  BoundedQueue<int> queue(1);
  queue.push(1);
  std::thread producer([&] { EXPECT_FALSE(queue.push(2)); });
  while (queue.waits() == 0) std::this_thread::yield();
  queue.close();
  producer.join();
}

TEST(BoundedQueue, EndsAWaitWhenItIsWoken) {
  BoundedQueue<int> queue(1);
  std::thread consumer([&] {
    std::vector<int> out;
    EXPECT_EQ(queue.pop(out, 1, 60s), 0U);
  });
  queue.wake();
  consumer.join();
}

}  // namespace
}  // namespace reident
