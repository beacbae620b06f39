#include "service/web/questions.hpp"

#include <gtest/gtest.h>

namespace reident::web {
namespace {

HttpRequest request(std::vector<std::pair<std::string, std::string>> query) {
  HttpRequest asked;
  asked.query = std::move(query);
  return asked;
}

TEST(Questions, ReadARangeOrSayWhatIsWrongWithIt) {
  const storage::TimeRange otherwise{10, 20};
  EXPECT_EQ(range_of(request({}), otherwise), otherwise);
  EXPECT_EQ(
      range_of(request({{"begin", "1970-01-01T00:00:01.000000001Z"}, {"end", "2"}}), otherwise),
      (storage::TimeRange{1'000'000'001, 2'000'000'000}));
  EXPECT_THROW(range_of(request({{"begin", "2"}, {"end", "1"}}), otherwise), BadRequest);
  EXPECT_THROW(range_of(request({{"begin", "yesterday"}}), otherwise), BadRequest);
  EXPECT_THROW(range_of(request({{"begin", "1700-01-01"}}), otherwise), BadRequest);
}

TEST(Questions, BoundTheBins) {
  const storage::TimeRange hour{0, 3600 * storage::second_ns};
  EXPECT_EQ(bins_of(request({{"bins", "360"}}), hour).length(), 10 * storage::second_ns);
  EXPECT_EQ(bins_of(request({{"bins", "4000"}}), {0, storage::second_ns}).length(), 1'000'000);
  for (const char* bins : {"0", "4001", "-1", "ten", "1e3", "99999999999999999999"})
    EXPECT_THROW(bins_of(request({{"bins", bins}}), hour), BadRequest) << bins;
}

storage::Decision decision(storage::Time time, const std::string& evidence) {
  storage::Decision made;
  made.time = time;
  made.evidence_json = evidence;
  return made;
}

// A service that runs through years of telemetry in a day decides by another clock than the axis.
TEST(TelemetryClock, PlacesDecisionsWhereTelemetryWas) {
  TelemetryClock clock(storage::TimeRange{1000, 9000});
  EXPECT_EQ(clock.place_of(decision(777'000, R"({"until_ns": 3000})")), 3000);
  EXPECT_EQ(clock.place_of(decision(778'000, "")), 3000) << "an operator's, shortly after";
  EXPECT_EQ(clock.place_of(decision(5000, "")), 5000) << "in real time";
  EXPECT_EQ(clock.place_of(decision(779'000, R"({"until_ns": 8000})")), 8000);
  EXPECT_EQ(TelemetryClock(storage::TimeRange{1000, 9000}).place_of(decision(777'000, "")), 9000);
  EXPECT_EQ(TelemetryClock(std::nullopt).place_of(decision(777'000, "")), 777'000);
}

}  // namespace
}  // namespace reident::web
