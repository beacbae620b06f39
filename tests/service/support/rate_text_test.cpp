#include "service/support/rate_text.hpp"

#include <gmock/gmock.h>

namespace reident {
namespace {

TEST(RateText, IsACountOverAUnitOfTime) {
  EXPECT_EQ(parse_rate("100/s"), 100);
  EXPECT_EQ(parse_rate("0.5/s"), 0.5);
  EXPECT_EQ(parse_rate("6/min"), 0.1);
  EXPECT_EQ(parse_rate("36/h"), 0.01);
}

TEST(RateText, IsRefusedWhereItIsNoRate) {
  for (const char* text : {"", "100", "/s", "100/", "100/d", "0/s", "-1/s", "nan/s", "inf/s", "x/s",
                           "1/s/s", "100 per s"})
    EXPECT_EQ(parse_rate(text), std::nullopt) << text;
}

}  // namespace
}  // namespace reident
