#include "service/support/stop_signal.hpp"

#include <chrono>
#include <csignal>
#include <unistd.h>

#include <gtest/gtest.h>

namespace reident::stop_signal_test {
namespace {

using namespace std::chrono_literals;

bool stops_within(const StopSignal& stop, std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!stop.token().stop_requested() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(1ms);  // poll
  }
  return stop.token().stop_requested();
}

TEST(StopSignal, RequestsAStopAndKnowsTheSignal) {
  for (const int number : {SIGINT, SIGTERM}) {
    const StopSignal stop;
    EXPECT_EQ(stop.number(), 0);
    EXPECT_FALSE(stop.token().stop_requested());
    kill(getpid(), number);
    EXPECT_TRUE(stops_within(stop, 10s));
    EXPECT_EQ(stop.number(), number);
  }
}

TEST(StopSignal, LetsTheSecondSignalEndTheProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        const StopSignal stop;
        kill(getpid(), SIGTERM);
        if (stops_within(stop, 10s)) kill(getpid(), SIGINT);
        pause();  // until the signal
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace reident::stop_signal_test
