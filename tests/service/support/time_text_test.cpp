#include "service/support/time_text.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace reident::time_text_test {
namespace {

constexpr std::int64_t second = 1'000'000'000;

struct Case {
  const char* text;
  std::optional<std::int64_t> ns;
};

void check(const std::vector<Case>& cases, std::optional<std::int64_t> (*parse)(std::string_view)) {
  for (const auto& [text, ns] : cases) EXPECT_EQ(parse(text), ns) << "'" << text << "'";
}

TEST(ParseTime, ReadsDecimalSecondsWithoutRounding) {
  check({{"0", 0},
         {"1234553735.093", 1'234'553'735'093'000'000},
         {"1682785357", 1'682'785'357 * second},
         {"1682785357.123456789", 1'682'785'357'123'456'789},
         {" +1.5 ", 1'500'000'000},
         {"-0.000000001", -1},
         {".5", second / 2},
         {"5.", 5 * second},
         {"1.682785357e9", 1'682'785'357 * second},
         {"1682785357000E-3", 1'682'785'357 * second},
         {"1e+03", 1000 * second},
         {"0.0000000014", 1},
         {"0.0000000015", 2},
         {"1e-30", 0},
         {"0e300", 0},
         {"9223372036.7", 9'223'372'036'700'000'000}},
        parse_time);
}

TEST(ParseTime, ReadsCalendarTimes) {
  constexpr std::int64_t april = 1'682'785'357 * second;  // date -u -d @1682785357
  check({{"2023-04-29T16:22:37Z", april},
         {"2023-04-29 16:22:37", april},
         {"2023-04-29t16:22:37.5z", april + second / 2},
         {"2023-04-29T16:22:37.093000001Z", april + 93'000'001},
         {"2023-04-29T18:22:37+02:00", april},
         {"2023-04-29T18:22:37+0200", april},
         {"2023-04-29T18:22:37 +02", april},
         {"2023-04-29T12:52:37-03:30", april},
         {"2023-04-29T16:22", april - 37 * second},
         {"2023-04-29", april - (16 * 3600 + 22 * 60 + 37) * second},
         {"2023/3/2 00:00", 1'677'715'200 * second},
         {"2023/03/02 0:00:01.5", 1'677'715'201 * second + second / 2},
         {"1969-12-31T23:59:59.999999999Z", -1},
         {"2016-12-31T23:59:60Z", 1'483'228'800 * second},
         {"2024-02-29", 1'709'164'800 * second}},
        parse_time);
}

TEST(ParseTime, RefusesWhatIsNoTime) {
  for (const char* text : {"",
                           " ",
                           "-",
                           ".",
                           "abc",
                           "12 34",
                           "1.2.3",
                           "0x10",
                           "nan",
                           "inf",
                           "1e",
                           "1e99",
                           "--1",
                           "1682785357000",
                           "2023-13-01",
                           "2023-02-29",
                           "2023-4-2",
                           "2023-04-29T",
                           "2023-04-29T24:00",
                           "2023-04-29T10:60",
                           "2023-04-29T10:00:61",
                           "2023-04-29T10:00:00.",
                           "2023-04-29T10:00X",
                           "2023-04-29T10:00+2",
                           "2023-04-29T10:00+02:00:00",
                           "2023-04-29X10:00",
                           "2023/4-29",
                           "9999-01-01",
                           "1600-01-01"}) {
    EXPECT_EQ(parse_time(text), std::nullopt) << "'" << text << "'";
  }
}

TEST(ParseDuration, ReadsUnits) {
  check({{"500ms", second / 2},
         {"2.5s", 5 * second / 2},
         {"90min", 5400 * second},
         {"2h", 7200 * second},
         {"3d", 3 * 86'400 * second},
         {"10us", 10'000},
         {"250ns", 250},
         {"12", 12 * second},
         {" 1.5 h ", 5400 * second},
         {"-1s", -second},
         {"0", 0},
         {"", std::nullopt},
         {"h", std::nullopt},
         {"3 weeks", std::nullopt},
         {"1h30min", std::nullopt},
         {"5S", std::nullopt},
         {"200000d", std::nullopt}},
        parse_duration);
}

TEST(TimeText, WritesAsManyDecimalsAsTheTimeHas) {
  EXPECT_EQ(time_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(time_text(1'682'785'357 * second), "2023-04-29T16:22:37Z");
  EXPECT_EQ(time_text(1'234'553'735'093'000'000), "2009-02-13T19:35:35.093Z");
  EXPECT_EQ(time_text(-1), "1969-12-31T23:59:59.999999999Z");
}

TEST(DurationText, UsesTheLargestUnitThatDivides) {
  EXPECT_EQ(duration_text(0), "0s");
  EXPECT_EQ(duration_text(second / 2), "500ms");
  EXPECT_EQ(duration_text(5400 * second), "90min");
  EXPECT_EQ(duration_text(-2 * 86'400 * second), "-2d");
  EXPECT_EQ(duration_text(1), "1ns");
}

RC_GTEST_PROP(TimeText, GivesEveryTimeBack, (std::int64_t time)) {
  RC_ASSERT(parse_time(time_text(time)) == time);
}

RC_GTEST_PROP(DurationText, GivesEveryDurationBack, (std::int64_t duration)) {
  RC_ASSERT(parse_duration(duration_text(duration)) == duration);
}

TEST(TimeText, GivesTheExtremesBack) {
  using Limits = std::numeric_limits<std::int64_t>;
  for (const auto time : {Limits::min(), Limits::max()}) {
    EXPECT_EQ(parse_time(time_text(time)), time);
    EXPECT_EQ(parse_duration(duration_text(time)), time);
  }
}

TEST(ParseMoment, KnowsNowAndHowLongBefore) {
  constexpr std::int64_t s = 1'000'000'000, now = 1'700'000'000 * s;
  EXPECT_EQ(parse_moment("now", now), now);
  EXPECT_EQ(parse_moment("-2h", now), now - 7200 * s);
  EXPECT_EQ(parse_moment("-90min", now), now - 5400 * s);
  EXPECT_EQ(parse_moment("-5", now), -5 * s) << "seconds since 1970, as ever";
  EXPECT_EQ(parse_moment("2023-11-14T22:13:20Z", now), now);
  EXPECT_EQ(parse_moment("-2 weeks", now), std::nullopt);
  EXPECT_EQ(parse_moment("2h", now), std::nullopt);
  EXPECT_EQ(parse_moment("-99999d", INT64_MIN), std::nullopt);
}

TEST(RoughDurationText, IsTheLargestUnit) {
  constexpr std::int64_t s = 1'000'000'000;
  EXPECT_EQ(rough_duration_text(0), "0s");
  EXPECT_EQ(rough_duration_text(59 * s), "59s");
  EXPECT_EQ(rough_duration_text(125 * s), "2min");
  EXPECT_EQ(rough_duration_text(7199 * s), "1h");
  EXPECT_EQ(rough_duration_text(500 * 86'400 * s), "500d");
  EXPECT_EQ(rough_duration_text(9 * 365 * 86'400 * s), "9y");
  EXPECT_EQ(rough_duration_text(-30 * s), "-30s");
  EXPECT_EQ(rough_duration_text(INT64_MIN), "-292y");
}

}  // namespace
}  // namespace reident::time_text_test
