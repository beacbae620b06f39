#include "service/satcs/platform/platform_spacecraft.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "service/satcs/family.hpp"
#include "tests/service/satcs/readings.hpp"

namespace reident::satcs::platform::platform_spacecraft_test {
namespace {

constexpr storage::Time july = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z

using test::same;

std::vector<std::vector<storage::Sample>> readings(std::uint64_t seed, int seconds) {
  return test::readings(PlatformSpacecraft({}, {}, july, seed), seconds);
}

TEST(PlatformSpacecraft, GivesTheSameTelemetryForTheSameSeed) {
  const auto first = readings(7, 900);
  const auto again = readings(7, 900);
  const auto other = readings(8, 900);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_TRUE(same(first[i], again[i])) << i;
    equal += same(first[i], other[i]);
  }
  EXPECT_EQ(equal, 0U);
}

TEST(PlatformSpacecraft, HasNoParameterOfThePowerSubsystem) {
  std::set<std::string> names;
  std::set<std::uint32_t> ids;
  std::size_t points = 0;
  for (const Family family : {Family::power, Family::platform})
    for (const auto& d : family_descriptors(family, "S")) {
      names.insert(d.name);
      ids.insert(d.id);
      ++points;
      ASSERT_NE(find_point(d.name), nullptr);
      EXPECT_EQ(find_point(d.name)->description, d.description);
    }
  EXPECT_EQ(names.size(), points);
  EXPECT_EQ(ids.size(), points);
  EXPECT_EQ(find_point("V_NONE"), nullptr);
}

TEST(PlatformSpacecraft, ReadsEachPointAtItsRateAndWithinItsRange) {
  PlatformSpacecraft spacecraft({}, {}, july, 1);
  std::map<std::uint32_t, int> count;
  std::vector<storage::Sample> samples;
  for (int s = 0; s < 320; ++s, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const auto& sample : samples) {
      ++count[sample.parameter];
      EXPECT_TRUE(std::isfinite(sample.value));
    }
  }
  for (const TelemetryPoint& point : telemetry_points())
    EXPECT_EQ(count[parameter_id(point.name)], 320 / point.every_s) << point.name;
}

TEST(PlatformSpacecraft, HasEveryTemperatureInARowOfAFileAtSixteenSeconds) {
  for (const TelemetryPoint& point : telemetry_points())
    if (point.name.starts_with("T_") && !point.name.ends_with("B")) {
      EXPECT_TRUE(point.due(16)) << point.name;
    }
}

struct Relation {
  std::vector<std::pair<double, std::string_view>> terms;  // their sum is about 0
  double tolerance;
};

TEST(PlatformSpacecraft, SecondMeasurementsAndSumsAgree) {
  const std::vector<Relation> relations{
      {{{1, "V_HB"}, {-1, "V_HBB"}}, 0.15},
      {{{1, "I_HALL"}, {-1, "I_H1"}, {-1, "I_H2"}, {-1, "I_H3"}, {-1, "I_H4"}}, 0.1},
      {{{1, "I_PA"}, {-1, "I_PAD"}}, 0.08},
      {{{1, "T_DECK"}, {-1, "T_DECKB"}}, 0.5},
      {{{1, "T_WPL"}, {-1, "T_WPLB"}}, 0.5},
      {{{1, "T_TPL"}, {-1, "T_TPLB"}}, 0.5},
      {{{1, "T_TANK"}, {-1, "T_TANKB"}}, 0.5},
  };
  PlatformSpacecraft spacecraft({}, {}, july, 5);
  std::map<std::uint32_t, double> last;
  std::vector<storage::Sample> samples;
  for (int s = 0; s < 2 * 6016; ++s, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const storage::Sample& sample : samples) last[sample.parameter] = sample.value;
    if (s < 32) continue;  // until every point was sampled
    for (const Relation& relation : relations) {
      double sum = 0;
      for (const auto& [factor, name] : relation.terms) sum += factor * last.at(parameter_id(name));
      ASSERT_LT(std::abs(sum), relation.tolerance) << relation.terms.front().second << " at " << s;
    }
  }
}

TEST(PlatformSpacecraft, FinerStepsChangeTemperaturesByLessThanTheirNoise) {
  PlatformPlant coarse({}, {}, july, 1, 4), fine({}, {}, july, 1, 20);
  std::array<double, node_count> squares{};
  for (int s = 0; s < 1500; ++s) {
    for (int k = 0; k < 4; ++k) coarse.step();
    for (int k = 0; k < 20; ++k) fine.step();
    for (std::size_t node = 0; node < node_count; ++node)
      squares[node] +=
          std::pow(coarse.thermal().temperature_C(node) - fine.thermal().temperature_C(node), 2);
  }
  for (std::size_t node = 0; node < node_count; ++node)
    EXPECT_LT(std::sqrt(squares[node] / 1500), 0.05) << node;
}

}  // namespace
}  // namespace reident::satcs::platform::platform_spacecraft_test
