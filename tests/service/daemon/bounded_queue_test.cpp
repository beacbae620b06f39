#include "service/daemon/bounded_queue.hpp"

#include <numeric>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace reident {

template <>
struct QueuedBytes<std::string> {
  std::size_t operator()(const std::string& text) const { return text.size(); }
};

namespace bounded_queue_test {
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

TEST(BoundedQueue, HoldsTheProducerBackAtItsBoundInBytesTooButTakesASingleItemThatExceedsIt) {
  BoundedQueue<std::string> queue({100, 10});
  EXPECT_TRUE(queue.push(std::string(25, 'a')));
  std::thread producer([&] {
    for (const std::size_t size : {6U, 4U, 1U}) queue.push(std::string(size, 'b'));
  });
  std::vector<std::string> out;
  EXPECT_EQ(queue.pop(out, 100, 60s, 60s), 1U) << "it gathers until the producer has to wait";
  EXPECT_EQ(queue.pop(out, 100, 60s, 60s), 2U);
  producer.join();
  EXPECT_EQ(queue.pop(out, 100, 60s), 1U);
}

TEST(BoundedQueue, TakesManyItemsInOneGoAndWaitsForRoomForThemToo) {
  BoundedQueue<int> queue(3);
  std::vector<int> items{0, 1, 2, 3, 4, 5, 6};
  std::thread producer([&] {
    EXPECT_TRUE(queue.push(items));
    EXPECT_TRUE(items.empty());
    queue.close();
  });
  std::vector<int> out;
  while (!queue.drained()) queue.pop(out, 2, 60s);
  producer.join();
  EXPECT_EQ(out, (std::vector{0, 1, 2, 3, 4, 5, 6}));
}

TEST(BoundedQueue, GathersUntilThereAreEnough) {
  BoundedQueue<int> queue(100);
  std::thread producer([&] {
    for (int i = 0; i < 10; ++i) queue.push(int{i});
  });
  std::vector<int> out;
  EXPECT_EQ(queue.pop(out, 10, 60s, 60s), 10U);
  producer.join();
}

TEST(BoundedQueue, GivesNoMoreBytesThanAreAskedForAndGathersNoMore) {
  BoundedQueue<std::string> queue(100);
  for (const std::size_t size : {6U, 4U, 1U, 25U}) queue.push(std::string(size, 'c'));
  std::vector<std::string> out;
  EXPECT_EQ(queue.pop(out, {100, 10}, 0ns, 60s), 2U);
  EXPECT_EQ(queue.pop(out, {100, 10}, 0ns, 60s), 1U);
  EXPECT_EQ(queue.pop(out, {100, 10}, 0ns, 60s), 1U) << "a single item may have more";
}

TEST(BoundedQueue, GivesWhatItHasWhenTheTimeToGatherIsOver) {
  BoundedQueue<int> queue(100);
  queue.push(1);
  std::vector<int> out;
  EXPECT_EQ(queue.pop(out, 10, 60s, 1ms), 1U);
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
}  // namespace bounded_queue_test
}  // namespace reident
