#include "service/cli/output/throughput.hpp"

#include <gtest/gtest.h>

namespace reident::cli::throughput_test {
namespace {

using std::chrono::seconds;

TEST(Throughput, CountsAndDurationsAreShort) {
  EXPECT_EQ(short_count(9999), "9999");
  EXPECT_EQ(short_count(12345), "12.3 k");
  EXPECT_EQ(short_count(1234567), "1.23 M");
  EXPECT_EQ(short_count(5.5e10), "55 G");
  EXPECT_EQ(rough_duration(2), "2s");
  EXPECT_EQ(rough_duration(3001), "50min");
  EXPECT_EQ(rough_duration(4 * 3600), "4.0h");
  EXPECT_EQ(rough_duration(10 * 86400), "10.0d");
}

TEST(Throughput, TellsTheTimeLeftFromWhatThisRunDid) {
  const Throughput::Clock::time_point start{};
  Throughput pace(start);
  // The first half lay behind it when it began.
  EXPECT_EQ(pace.text(0.5, 1000, start + seconds(1)), "1000 samples, 1000/s");
  EXPECT_EQ(pace.text(0.625, 11000, start + seconds(11)), "11 k samples, 1000/s, 30s left");
}

}  // namespace
}  // namespace reident::cli::throughput_test
