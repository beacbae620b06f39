#include "service/web/disbelieved.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace reident::web {
namespace {

constexpr storage::Time hour = 3600 * storage::second_ns;

storage::Attempt attempt(const std::string& equipment, storage::TimeRange window,
                         const std::vector<storage::TimeRange>& excluded) {
  nlohmann::json longest = nlohmann::json::array();
  for (const storage::TimeRange& range : excluded)
    longest.push_back({{"check", "stuck"},
                       {"parameters", {"V_BUS"}},
                       {"begin_ns", range.begin},
                       {"end_ns", range.end}});
  storage::Attempt made;
  made.spacecraft = "SAT";
  made.equipment = equipment;
  made.window = window;
  made.evidence_json =
      nlohmann::json{{"implausible", {{"stretches", longest.size() + 1}, {"longest", longest}}}}
          .dump();
  return made;
}

TEST(DisbelievedSensors, AreThereAsLongAsWindowsThatFollowEachOtherFindThem) {
  DisbelievedSensors sensors(0);
  sensors.add(attempt("A", {0, 10 * hour}, {}));  // the fault's first hour is too short to be found
  sensors.add(attempt("A", {5 * hour, 15 * hour}, {{9 * hour, 15 * hour}}));
  sensors.add(attempt("B", {7 * hour, 17 * hour}, {{9 * hour, 17 * hour}}));
  sensors.add(
      attempt("A", {10 * hour, 20 * hour}, {{10 * hour, 16 * hour}, {18 * hour, 19 * hour}}));
  EXPECT_EQ(sensors.left_out(), 4U);
  const auto found = std::move(sensors).take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].range, (storage::TimeRange{18 * hour, 19 * hour}));
  EXPECT_EQ(found[0].equipment, std::set<std::string>{"A"});
  EXPECT_EQ(found[1].range, (storage::TimeRange{9 * hour, 17 * hour}));
  EXPECT_EQ(found[1].equipment, (std::set<std::string>{"A", "B"}));
  EXPECT_EQ(found[1].stretches, 1U);
}

TEST(DisbelievedSensors, WhatComesAgainSoonIsOneFault) {
  DisbelievedSensors sensors(hour);
  sensors.add(
      attempt("A", {0, 10 * hour}, {{hour, hour + 9}, {2 * hour, 3 * hour}, {6 * hour, 7 * hour}}));
  const auto found = std::move(sensors).take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].range, (storage::TimeRange{hour, 3 * hour}));
  EXPECT_EQ(found[1].stretches, 2U);
}

}  // namespace
}  // namespace reident::web
