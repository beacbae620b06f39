#include "service/daemon/repeated_error.hpp"

#include <gtest/gtest.h>

namespace reident::repeated_error_test {
namespace {

TEST(RepeatedError, IsNewsUntilItComesAgain) {
  RepeatedError failure;
  EXPECT_TRUE(failure.is_news("no room"));
  EXPECT_FALSE(failure.is_news("no room"));
  EXPECT_TRUE(failure.is_news("damaged"));
  EXPECT_TRUE(failure.is_news("no room"));
}

TEST(RepeatedError, IsNewsAgainAfterASuccess) {
  RepeatedError failure;
  EXPECT_TRUE(failure.is_news("no room"));
  failure.succeeded();
  EXPECT_TRUE(failure.is_news("no room"));
}

}  // namespace
}  // namespace reident::repeated_error_test
