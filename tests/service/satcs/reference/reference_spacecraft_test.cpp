#include "service/satcs/reference/reference_spacecraft.hpp"

#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/satcs/parameter_id.hpp"
#include "tests/service/satcs/readings.hpp"

namespace reident::satcs::reference::reference_spacecraft_test {
namespace {

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z

using test::same;

std::vector<std::vector<storage::Sample>> readings(std::uint64_t seed, int seconds) {
  return test::readings(Spacecraft(Constants{}, {}, july, seed), seconds);
}

TEST(ReferenceSpacecraft, GivesTheSameTelemetryForTheSameSeed) {
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

/// FNV-1a over the bits of all readings.
std::uint64_t digest_of(const std::vector<std::vector<storage::Sample>>& readings) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](std::uint64_t bits) { hash = (hash ^ bits) * 1099511628211ULL; };
  for (const auto& reading : readings)
    for (const storage::Sample& sample : reading) {
      add(sample.parameter);
      add(std::bit_cast<std::uint64_t>(sample.value));
    }
  return hash;
}

// Readings are steps of a converter, so that a mathematical library's last bit seldom shows.
TEST(ReferenceSpacecraft, KeepsTheTelemetryThatItHadBeforeThePlatformWasAdded) {
  EXPECT_EQ(digest_of(readings(7, 6016)), 2999143150844696296ULL);
}

TEST(ReferenceSpacecraft, PublishesTheParametersOfThePaper) {
  std::set<std::string> names;
  std::set<std::uint32_t> ids;
  for (const auto& d : telemetry_descriptors("SAT")) {
    EXPECT_EQ(d.spacecraft, "SAT");
    EXPECT_EQ(d.id, parameter_id(d.name));
    EXPECT_FALSE(d.description.empty());
    names.insert(d.name);
    ids.insert(d.id);
  }
  EXPECT_EQ(ids.size(), telemetry_points().size());
  for (const char* name : {"I_BDRIN1", "I_BDRIN2", "I_BDROUT", "I_BAT1", "I_SAG1A", "I_SGBCHC",
                           "V_BUS", "V_BAT1", "I_SG2", "I_BUS", "V_MEA"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
}

TEST(ReferenceSpacecraft, ReadsEachPointAtItsRateAndPhase) {
  Spacecraft spacecraft(Constants{}, {}, july, 1);
  std::map<std::uint32_t, int> count;
  std::vector<storage::Sample> samples;
  for (int s = 0; s < 64; ++s, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const storage::Sample& sample : samples) ++count[sample.parameter];
  }
  std::set<int> phases;
  for (const TelemetryPoint& point : telemetry_points()) {
    EXPECT_EQ(count[parameter_id(point.name)], 64 / point.every_s) << point.name;
    if (point.every_s == 16) phases.insert(point.phase_s);
  }
  EXPECT_GT(phases.size(), 6U);  // sub-commutated, not all at once
  EXPECT_TRUE(telemetry_points().front().due(-1));
  TelemetryPoint fourth;
  fourth.every_s = 4;
  fourth.phase_s = 3;
  EXPECT_TRUE(fourth.due(-1));
  EXPECT_FALSE(fourth.due(0));
}

TEST(ReferenceSpacecraft, ReadsInStepsOfTheConverter) {
  std::map<std::uint32_t, const TelemetryPoint*> of_id;
  for (const TelemetryPoint& point : telemetry_points()) of_id[parameter_id(point.name)] = &point;
  Spacecraft spacecraft(Constants{}, {}, july, 1);
  std::vector<storage::Sample> samples;
  for (int s = 0; s < 600; ++s, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const storage::Sample& sample : samples) {
      const TelemetryPoint& point = *of_id.at(sample.parameter);
      const double value = sample.value;
      EXPECT_EQ(sample.quality, storage::Quality::good);
      if (point.kind == storage::ParameterKind::digital) {
        EXPECT_TRUE(value == 0 || value == 1) << point.name;
        continue;
      }
      const double steps = (value - point.sensor.low) / point.sensor.quantum();
      EXPECT_NEAR(steps, std::round(steps), 1e-6) << point.name;
      EXPECT_GE(steps, -1e-6);
      EXPECT_LE(steps, 4095 + 1e-6);
    }
  }
}

TEST(ReferenceSpacecraft, CurrentsOfTheBusAddUpButForNoise) {
  Spacecraft spacecraft(Constants{}, {}, july, 2);
  std::map<std::string_view, std::size_t> at;
  for (std::size_t i = 0; i < telemetry_points().size(); ++i) at[telemetry_points()[i].name] = i;
  const auto& sensor = telemetry_points()[at["I_BUS"]].sensor;
  const double most = 6 * std::sqrt(3.0) * sensor.noise + 2 * sensor.quantum();
  std::vector<storage::Sample> samples;
  for (int s = 0; s < 6016; ++s, spacecraft.advance()) {
    const auto exact = spacecraft.noise_free();
    ASSERT_NEAR(exact[at["I_BUS"]], exact[at["I_SG2"]] + exact[at["I_BDROUT"]], 1e-10);
    spacecraft.read(samples);
    std::map<std::uint32_t, double> value;
    for (const storage::Sample& sample : samples) value[sample.parameter] = sample.value;
    ASSERT_NEAR(value.at(parameter_id("I_BUS")),
                value.at(parameter_id("I_SG2")) + value.at(parameter_id("I_BDROUT")), most);
  }
}

/// What every sensor has behind its filter, second by second.
class Filtered {
 public:
  explicit Filtered(int steps_per_second) : plant_(Constants{}, {}, july, 3, steps_per_second) {
    for (const TelemetryPoint& point : telemetry_points())
      sensors_.emplace_back(point.sensor, plant_.step_s(), 1, 1);
  }
  void advance() {
    for (int step = 0; step < plant_.steps_per_second(); ++step) {
      plant_.step();
      for (std::size_t i = 0; i < sensors_.size(); ++i)
        sensors_[i].observe(telemetry_points()[i].read(plant_));
    }
  }
  double operator[](std::size_t point) const { return sensors_[point].filtered(); }

 private:
  Plant plant_;
  std::vector<Sensor> sensors_;
};

TEST(ReferenceSpacecraft, FinerStepsChangeReadingsByLessThanTheirNoise) {
  Filtered usual(Plant::usual_steps_per_second), fine(5 * Plant::usual_steps_per_second);
  const auto points = telemetry_points();
  std::vector<double> square(points.size());
  constexpr int orbit_s = 6016;
  for (int s = 0; s < orbit_s; ++s) {
    usual.advance();
    fine.advance();
    for (std::size_t i = 0; i < points.size(); ++i)
      square[i] += std::pow(usual[i] - fine[i], 2) / orbit_s;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].kind == storage::ParameterKind::digital) continue;
    EXPECT_LT(std::sqrt(square[i]), 0.25 * points[i].sensor.noise) << points[i].name;
  }
}

TEST(ReferenceSpacecraft, StartsOnAWholeSecondAndGoesOnBySeconds) {
  Spacecraft spacecraft(Constants{}, {}, july + 1, 1);
  EXPECT_EQ(spacecraft.time(), july);
  spacecraft.advance();
  EXPECT_EQ(spacecraft.time(), july + second);
  EXPECT_EQ(Spacecraft(Constants{}, {}, -1, 1).time(), -second);
}

TEST(ReferenceSensor, FollowsAStepWithItsTimeConstant) {
  Sensor sensor({.time_constant_s = 2, .noise = 0, .low = -1, .high = 1, .bits = 12}, 0.05, 1, 1);
  sensor.observe(0);
  for (int i = 0; i < 40; ++i) sensor.observe(1);
  EXPECT_NEAR(sensor.filtered(), 1 - std::exp(-1), 1e-12);
  EXPECT_NEAR(sensor.read(), 1 - std::exp(-1), 2.0 / 4095);
}

TEST(ReferenceSensor, HoldsToItsRangeAndHasItsNoise) {
  const SensorSpec spec{.time_constant_s = 1, .noise = 0.5, .low = 0, .high = 20, .bits = 12};
  Sensor sensor(spec, 0.05, 1, 1);
  sensor.observe(10);
  double mean = 0, square = 0;
  constexpr int n = 20'000;
  for (int i = 0; i < n; ++i) {
    const double deviation = sensor.read() - 10;
    mean += deviation / n;
    square += deviation * deviation / n;
  }
  EXPECT_NEAR(mean, 0, 0.02);
  EXPECT_NEAR(std::sqrt(square), 0.5, 0.01);
  for (int i = 0; i < 2000; ++i) sensor.observe(25);
  for (int i = 0; i < 100; ++i) EXPECT_LE(sensor.read(), 20);
}

}  // namespace
}  // namespace reident::satcs::reference::reference_spacecraft_test
