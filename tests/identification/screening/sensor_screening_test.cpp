#include "identification/screening/sensor_screening.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reident::identification::sensor_screening_test {
namespace {

constexpr double pi = 3.14159265358979;

double quantised(double value, double step) {
  return std::round(value / step) * step;
}

/// Five orbits of an array in eclipse for a third of each, a noisy load current, a bus that is
/// regulated in sunlight, a slow quantised temperature, and a battery's voltage.
struct Telemetry {
  enum Channel : Index { array, load, bus, temperature, battery };
  Record record;

  explicit Telemetry(unsigned seed = 1, Index rows = 30'000) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    Matrix u(rows, 4), y(rows, 1);
    for (Index t = 0; t < rows; ++t) {
      const double phase = double(t % 6'000) / 6'000;
      const bool is_dark = phase > 0.65;
      u(t, 0) =
          is_dark ? 0 : quantised(10 + 3 * std::sin(2 * pi * phase) + 0.05 * noise(random), 0.02);
      u(t, 1) = quantised(5 + double(t / 431 % 3) + 0.05 * noise(random), 0.02);
      u(t, 2) = is_dark ? quantised(27.5 - 0.3 * phase + 0.01 * noise(random), 0.01) : 28;
      u(t, 3) = quantised(15 + 5 * std::sin(2 * pi * phase), 0.25);
      y(t, 0) = quantised(50 + 3 * std::sin(2 * pi * phase) + 0.03 * noise(random), 0.02);
    }
    record = contiguous_record(1, u, y);
  }
  auto channel(Index c) { return c < 4 ? record.u.col(c) : record.y.col(c - 4); }
  std::vector<SensorFault> faults() const {
    return sensor_faults(record, std::vector<bool>(5, true));
  }
};

TEST(Screening, FindsNothingInHonestTelemetry) {
  for (unsigned seed = 1; seed <= 10; ++seed) EXPECT_TRUE(Telemetry(seed).faults().empty()) << seed;
}

TEST(Screening, FindsASensorThatIsStuck) {
  for (const Index c : {Telemetry::array, Telemetry::load, Telemetry::battery}) {
    Telemetry telemetry;
    auto values = telemetry.channel(c);
    values.segment(7'001, 2'500).setConstant(values(7'000));
    const auto faults = telemetry.faults();
    if (c == Telemetry::array) continue;  // its eclipses are as long: left to the relations
    ASSERT_EQ(faults.size(), 1U) << c;
    EXPECT_EQ(faults[0].kind, SensorFaultKind::stuck);
    EXPECT_EQ(faults[0].channel, c);
    EXPECT_LE(faults[0].ticks.begin, 7'001);
    EXPECT_GE(faults[0].ticks.end, 9'501);
  }
}

TEST(Screening, DoesNotCallAQuietSpacecraftStuck) {
  Telemetry telemetry;
  for (Index c = 0; c < 5; ++c) {
    auto values = telemetry.channel(c);
    values.segment(7'001, 2'500).setConstant(values(7'000));
  }
  for (const SensorFault& fault : telemetry.faults())
    EXPECT_NE(fault.kind, SensorFaultKind::stuck) << fault.channel;
}

TEST(Screening, FindsSpikesAndLeavesMomentsThatTwoSensorsSawAlone) {
  Telemetry telemetry;
  telemetry.channel(Telemetry::load)(1'000) += 9;
  telemetry.channel(Telemetry::battery)(2'000) -= 8;
  telemetry.channel(Telemetry::load)(3'000) += 9;
  telemetry.channel(Telemetry::array)(3'000) += 9;
  const auto faults = telemetry.faults();
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].kind, SensorFaultKind::spike);
  EXPECT_EQ(faults[0].ticks, (TickRange{1'000, 1'001}));
  EXPECT_EQ(faults[1].channel, Telemetry::battery);
  EXPECT_EQ(faults[1].ticks, (TickRange{2'000, 2'001}));
}

TEST(Screening, LeavesAMomentInWhichAnotherSensorStepsAlone) {
  Telemetry telemetry;
  for (Index t = 3'900; t < 30'000; t += 6'000)  // the array goes dark, and the bus gives way
    telemetry.channel(Telemetry::bus)(t) = 27;
  EXPECT_TRUE(telemetry.faults().empty());
  telemetry.channel(Telemetry::bus)(2'000) = 27;
  const auto faults = telemetry.faults();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, SensorFaultKind::spike);
  EXPECT_EQ(faults[0].ticks.begin, 2'000);
}

TEST(Screening, FindsABurstOfNoiseInOneSensor) {
  Telemetry telemetry;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  for (Index t = 12'000; t < 13'000; ++t) telemetry.channel(Telemetry::battery)(t) += noise(random);
  const auto faults = telemetry.faults();
  ASSERT_FALSE(faults.empty());
  for (const SensorFault& fault : faults) EXPECT_EQ(fault.channel, Telemetry::battery);
  EXPECT_EQ(faults.back().kind, SensorFaultKind::noise);
  EXPECT_LE(faults.back().ticks.begin, 12'000);
  EXPECT_GE(faults.back().ticks.end, 13'000);
  EXPECT_LT(faults.back().ticks.end - faults.back().ticks.begin, 1'300);
}

TEST(Screening, DoesNotCallACommonDisturbanceNoise) {
  Telemetry telemetry;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  for (Index t = 12'000; t < 13'000; ++t) {
    const double ripple = noise(random);
    telemetry.channel(Telemetry::battery)(t) += ripple;
    telemetry.channel(Telemetry::load)(t) -= ripple;
  }
  for (const SensorFault& fault : telemetry.faults()) EXPECT_NE(fault.kind, SensorFaultKind::noise);
}

TEST(Screening, LooksAtAnalogChannelsAlone) {
  Telemetry telemetry;
  telemetry.channel(Telemetry::load)(1'000) += 9;
  EXPECT_TRUE(sensor_faults(telemetry.record, {true, false, true, true, true}).empty());
  EXPECT_TRUE(sensor_faults(Record{1, Matrix(0, 1), Matrix(0, 1), {}}, {true, true}).empty());
}

}  // namespace
}  // namespace reident::identification::sensor_screening_test
