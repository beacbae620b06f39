#include "service/transfer/telemetry_csv.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/telemetry_file/number_text.hpp"

namespace reident::transfer::telemetry_csv_test {
namespace {

using storage::Quality;

TEST(TelemetryCsv, ValuesComeBackBitForBit) {
  using Limits = std::numeric_limits<double>;
  for (const double value : {0.0, -0.0, 0.1, 1.0 / 3, 1e300, -2.5e-7, Limits::denorm_min(),
                             Limits::max(), Limits::infinity(), -Limits::infinity()}) {
    std::string text;
    append_value(text, value);
    const auto read = telemetry_file::plain_number(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*read), std::bit_cast<std::uint64_t>(value)) << text;
  }
  std::string nan;
  append_value(nan, -Limits::quiet_NaN());
  EXPECT_EQ(nan, "nan");
  EXPECT_TRUE(std::isnan(telemetry_file::plain_number(nan).value()));
}

TEST(TelemetryCsv, QualitiesAreReadAsTheyAreShown) {
  for (const Quality quality : storage::qualities)
    EXPECT_EQ(parse_quality(storage::name(quality)), quality);
  EXPECT_EQ(parse_quality(" out_of_limits "), Quality::out_of_limits);
  EXPECT_EQ(parse_quality("GOOD"), Quality::good);
  EXPECT_EQ(parse_quality("fine"), std::nullopt);
}

TEST(TelemetryCsv, TextIsQuotedWhereItHasTo) {
  const auto quoted = [](const char* text) {
    std::string line;
    append_text(line, text);
    return line;
  };
  EXPECT_EQ(quoted("SAT-1"), "SAT-1");
  EXPECT_EQ(quoted("a,b"), "\"a,b\"");
  EXPECT_EQ(quoted("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(quoted("a\nb"), "\"a\nb\"");
}

}  // namespace
}  // namespace reident::transfer::telemetry_csv_test
