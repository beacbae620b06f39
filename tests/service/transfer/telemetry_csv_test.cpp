#include "service/transfer/telemetry_csv.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace reident::transfer::telemetry_csv_test {
namespace {

using storage::Quality;

TEST(TelemetryCsv, ValuesComeBackBitForBit) {
  using Limits = std::numeric_limits<double>;
  for (const double value : {0.0, -0.0, 0.1, 1.0 / 3, 1e300, -2.5e-7, Limits::denorm_min(),
                             Limits::max(), Limits::infinity(), -Limits::infinity()}) {
    std::string text;
    append_value(text, value);
    const auto read = parse_value(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*read), std::bit_cast<std::uint64_t>(value)) << text;
  }
  std::string nan;
  append_value(nan, -Limits::quiet_NaN());
  EXPECT_EQ(nan, "nan");
  EXPECT_TRUE(std::isnan(parse_value(nan).value()));
}

TEST(TelemetryCsv, WhatIsNoNumberIsNoValue) {
  for (const char* cell : {"", " ", "n/a", "1,5", "1 2", "1x", "--", "1e999", "0x10"})
    EXPECT_EQ(parse_value(cell), std::nullopt) << cell;
}

TEST(TelemetryCsv, TimesAreReadByTheUnitThatTheyHave) {
  constexpr storage::Time time = 1'682'785'357'500'000'000;
  struct Case {
    TimeUnit unit;
    const char* cell;
    std::optional<storage::Time> time;
  };
  for (const auto& [unit, cell, expected] :
       {Case{TimeUnit::any, "1682785357.5", time}, Case{TimeUnit::any, "1682785357500000000", time},
        Case{TimeUnit::any, "2023-04-29T16:22:37.5Z", time},
        Case{TimeUnit::any, "-62785357500000000", -62'785'357'500'000'000},
        Case{TimeUnit::any, "1682785357500", std::nullopt}, Case{TimeUnit::any, "", std::nullopt},
        Case{TimeUnit::s, "1682785357.5", time}, Case{TimeUnit::ms, "1682785357500", time},
        Case{TimeUnit::us, " 1682785357500000 ", time}, Case{TimeUnit::ns, "17", 17},
        Case{TimeUnit::ms, "0.25", 250'000}, Case{TimeUnit::ms, "5s", std::nullopt},
        Case{TimeUnit::ms, "noon", std::nullopt}})
    EXPECT_EQ(parse_time_in(unit, cell), expected) << cell;
}

TEST(TelemetryCsv, ATimeColumnSaysItsUnit) {
  EXPECT_EQ(unit_of_column("time_ms"), TimeUnit::ms);
  EXPECT_EQ(unit_of_column("t_ns"), TimeUnit::ns);
  EXPECT_EQ(unit_of_column("unix_s"), TimeUnit::any) << "seconds, or a date all the same";
  EXPECT_EQ(unit_of_column("time"), TimeUnit::any);
}

TEST(TelemetryCsv, QualitiesAreReadAsTheyAreShown) {
  for (const Quality quality : storage::qualities)
    EXPECT_EQ(parse_quality(storage::name(quality)), quality);
  EXPECT_EQ(parse_quality(" out_of_limits "), Quality::out_of_limits);
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
