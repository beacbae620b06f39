#include "service/web/query_pool.hpp"

#include <gtest/gtest.h>

namespace reident::web {
namespace {

using namespace std::chrono_literals;

TEST(Allowance, IsABurstAndThenAShareOfTheTime) {
  const Allowance::Clock::time_point begin{};
  Allowance allowance(begin);
  EXPECT_TRUE(allowance.is_left(begin));
  allowance.take(Allowance::burst_s + 0.1);
  EXPECT_FALSE(allowance.is_left(begin));
  EXPECT_FALSE(allowance.is_left(begin + 1900ms));
  EXPECT_TRUE(allowance.is_left(begin + 2100ms));
  EXPECT_TRUE(allowance.is_left(begin + 24h));
  allowance.take(Allowance::burst_s + 0.1);  // a day without questions is no larger burst
  EXPECT_FALSE(allowance.is_left(begin + 24h));
}

}  // namespace
}  // namespace reident::web
