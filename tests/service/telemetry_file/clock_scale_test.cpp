// Leap seconds, epochs, and parts of a time that are not there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/service/telemetry_file/first_time.hpp"

namespace reident::telemetry_file::clock_scale_test {
namespace {

using test::first_time;
using testing::AllOf;
using testing::HasSubstr;

TEST(TelemetryClock, SaysAnEpochThatTakesLeapSecondsOut) {
  const auto epoch_said = [](const std::string& text) {
    const auto at = text.find("2000-01-01T11");
    return at == std::string::npos ? text : text.substr(at, sizeof("2000-01-01T11:58:50.816Z") - 1);
  };
  for (const auto& [name, cell, epoch, time] :
       {std::tuple("ET", "762000000.184", "2000-01-01T11:58:50.816Z", "2024-02-23T22:38:51Z"),
        {"Ephemeris Time (s)", "762000000.184", "2000-01-01T11:58:50.816Z", "2024-02-23T22:38:51Z"},
        {"t_j2000_s", "762000000.184", "2000-01-01T11:58:50.816Z", "2024-02-23T22:38:51Z"},
        {"Seconds since J2000", "0", "2000-01-01T11:58:55.816Z", "2000-01-01T11:58:55.816Z"},
        {"TDB seconds past J2000", "762000000.184", "2000-01-01T11:58:50.816Z",
         "2024-02-23T22:38:51Z"},
        {"seconds since 2000-01-01T12:00:00 TAI", "762000000", "2000-01-01T11:59:23Z",
         "2024-02-23T22:39:23Z"}}) {
    EXPECT_EQ(epoch_said(first_time(name, {cell})).substr(0, std::string(epoch).size()), epoch)
        << name;
    TimeOptions said;
    said.epoch_ns = parse_time(epoch);
    EXPECT_EQ(first_time(name, {cell}, said), time) << name;
  }
}

TEST(TelemetryClock, ReadsDaysAndMillisecondsOfTheDaySinceAnEpoch) {
  TimeOptions since;
  since.epoch_ns = parse_time("1958-01-01T00:00:00Z");
  for (const char* names : {"day,ms_of_day", "CDS_DAY,CDS_MS", "Days,Milliseconds of day"})
    EXPECT_EQ(first_time(names, {"24164,79200500"}, since), "2024-02-28T22:00:00.5Z") << names;
  EXPECT_EQ(first_time("days since 1958-01-01,msod", {"24164,79200500"}), "2024-02-28T22:00:00.5Z");
  EXPECT_THAT(first_time("day,ms_of_day", {"24164,79200500"}), HasSubstr("--epoch"));
  since.column = "a,b_ms";
  EXPECT_EQ(first_time("a,b_ms", {"24164,79200500"}, since), "2024-02-28T22:00:00.5Z");
}

TEST(TelemetryClock, PutsALeapSecondBetweenTheSecondsAroundIt) {
  std::vector<std::string> times;
  for (const char* cell :
       {"2016-12-31T23:59:59.9Z", "2016-12-31T23:59:60Z", "2016-12-31 23:59:60.5",
        "2017-01-01T00:59:60+01:00", "2017-01-01T00:00:00Z", "2017-01-01T00:00:00.5Z"})
    times.push_back(first_time("time", {cell}));
  EXPECT_THAT(times, testing::ElementsAre("2016-12-31T23:59:59.9Z", "2016-12-31T23:59:59.999Z",
                                          "2016-12-31T23:59:59.9995Z", "2016-12-31T23:59:59.999Z",
                                          "2017-01-01T00:00:00Z", "2017-01-01T00:00:00.5Z"));
  EXPECT_EQ(first_time("time", {"2016-12-30T23:59:60Z"}), "2016-12-31T00:00:00Z") << "rounded up";
}

TEST(TelemetryClock, AsksForTheYearOfDatesThatHaveNone) {
  for (const char* cell : {"Nov 27 10:00:00", "Mar  4 09:26:53", "28.02. 22:00:00",
                           "27 Nov 10:00:00", "28/02 22:00:00.5"}) {
    const std::string asked = first_time("time", {cell});
    const auto said = asked.rfind("as in '");
    ASSERT_NE(said, std::string::npos) << asked;
    EXPECT_THAT(first_time("time", {asked.substr(said + 7, asked.size() - said - 8)}),
                testing::StartsWith("2024-"));
  }
}

TEST(TelemetryClock, AsksWherePartsOfASecondMayLackTheirZeros) {
  std::vector<std::string> unpadded, trimmed;
  for (int row = 0; row < 40; ++row) {
    const std::string second = "2024-02-28 22:00:0" + std::to_string(row / 20) + ".";
    unpadded.push_back(second + std::to_string(row % 20 * 50));
    const std::string part = std::to_string(1000 + row % 20 * 50).substr(1);
    trimmed.push_back(second +
                      part.substr(0, std::max<std::size_t>(part.find_last_not_of('0') + 1, 1)));
  }
  EXPECT_THAT(first_time("time", unpadded), HasSubstr("t.csv:4: "));
  EXPECT_EQ(first_time("time", trimmed), "2024-02-28T22:00:00Z");
}

TEST(TelemetryClock, TakesLeapSecondsOutOfDatesWhereItIsTold) {
  const std::vector<std::string> cells = {"2024-02-28T22:00:18"};
  EXPECT_THAT(first_time("gps_time", cells), HasSubstr("--time-format gps"));
  EXPECT_THAT(first_time("time_TAI", cells), HasSubstr("--time-format iso"));
  EXPECT_THAT(first_time("gps_date,time", {"2024-02-28,22:00:18"}), HasSubstr("--time-format gps"));
  EXPECT_THAT(first_time("time,y", {cells[0] + ",1"}, {}, "# TIME_SYSTEM = TAI\n"),
              HasSubstr("by line 1"));
  EXPECT_THAT(first_time("tai_seconds_since_2000", {"762429600"}), HasSubstr("TAI"));
  EXPECT_EQ(first_time("GPS seconds since 1980-01-06", {"1393192818"}), "2024-02-28T22:00:00Z");
  EXPECT_EQ(first_time("gps_time", {"2024-02-28T22:00:18Z"}), "2024-02-28T22:00:18Z");
  TimeOptions format;
  format.format = TimeFormat::gps;
  EXPECT_EQ(first_time("gps_time", cells, format), "2024-02-28T22:00:00Z");
  EXPECT_EQ(first_time("gps_date,time", {"2024-02-28,22:00:18"}, format), "2024-02-28T22:00:00Z");
  format.format = TimeFormat::text;
  EXPECT_EQ(first_time("gps_time", cells, format), "2024-02-28T22:00:18Z");
}

TEST(TelemetryClock, AsksForTheOffsetOfDatesWhereOthersHaveOne) {
  const std::vector<std::string> cells = {"2024-02-28 23:00:00+01:00", "2024-02-28 22:00:10"};
  EXPECT_THAT(first_time("time", cells), AllOf(HasSubstr("t.csv:3: "), HasSubstr("--time-zone")));
  TimeOptions utc;
  utc.zone = "UTC";
  EXPECT_EQ(first_time("time", cells, utc), "2024-02-28T22:00:00Z");
}

TEST(TelemetryClock, AsksWhatNumbersCountThatWouldBeWeeksApart) {
  std::vector<std::string> cells;
  for (int row = 0; row < 6; ++row)
    cells.push_back(std::to_string(1'400'000'000 + row * 10'000'000));
  EXPECT_THAT(first_time("timestamp", cells), HasSubstr("--time-unit"));
  TimeOptions us;
  us.unit_ns = 1000;
  us.epoch_ns = parse_time("2024-02-28T00:00:00Z");
  EXPECT_EQ(first_time("timestamp", cells, us), "2024-02-28T00:23:20Z");
  EXPECT_EQ(first_time("unix_s", cells), "2014-05-13T16:53:20Z");
}

}  // namespace
}  // namespace reident::telemetry_file::clock_scale_test
