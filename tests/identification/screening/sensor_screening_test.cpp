#include "identification/screening/sensor_screening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "identification/samples/tick_ranges.hpp"

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

TEST(Screening, DoesNotCallACommandStuckWhoseLastLevelTheRecordCuts) {
  // A pump's speed: operations, each of its own level. Two rows of the last are in the record.
  struct Level {
    double value;
    Index rows;
  };
  Telemetry telemetry(1, 2'016);
  auto values = telemetry.channel(Telemetry::temperature);
  Index row = 0;
  for (const auto& [value, rows] :
       {Level{3'000, 84}, Level{5'790, 146}, Level{3'000, 48}, Level{5'180, 80}, Level{3'000, 677},
        Level{3'540, 172}, Level{3'000, 477}, Level{4'090, 168}, Level{3'000, 162},
        Level{3'590, 2}}) {
    values.segment(row, rows).setConstant(value);
    row += rows;
  }
  for (const SensorFault& fault : telemetry.faults())
    EXPECT_NE(fault.channel, Telemetry::temperature);
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

/// Ticks of the faults of one channel and kind.
TickSet ticks_of(const std::vector<SensorFault>& faults, SensorFaultKind kind, Index channel) {
  std::vector<TickRange> ticks;
  for (const SensorFault& fault : faults)
    if (fault.kind == kind && fault.channel == channel) ticks.push_back(fault.ticks);
  return united(std::move(ticks));
}

TEST(Screening, FindsAFillValueAtAnyShare) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  for (const double fill : {-999.0, 9999.0, -32768.0, 65535.0, -99.99, 1e30})
    for (const double share : {0.002, 0.04, 0.3, 0.7}) {
      Telemetry telemetry;
      std::vector<TickRange> filled;
      for (Index t = 0; t < 30'000; ++t)
        if (uniform(random) < share) {
          telemetry.channel(Telemetry::battery)(t) = fill;
          filled.push_back({t, t + 1});
        }
      const auto faults = telemetry.faults();
      EXPECT_EQ(ticks_of(faults, SensorFaultKind::fill, Telemetry::battery),
                united(std::move(filled)))
          << fill << " in " << share;
    }
}

TEST(Screening, FindsAnyFarValueThatIsScatteredOverTheRows) {
  for (const double fill : {0.0, -1.0, 999.25})
    for (const double share : {0.03, 0.2}) {
      std::mt19937 random(7);
      std::uniform_real_distribution<double> uniform;
      Telemetry telemetry;
      std::vector<TickRange> filled;
      for (Index t = 0; t < 30'000; ++t)
        if (uniform(random) < share) {
          telemetry.channel(Telemetry::battery)(t) = fill;
          filled.push_back({t, t + 1});
        }
      EXPECT_EQ(ticks_of(telemetry.faults(), SensorFaultKind::fill, Telemetry::battery),
                united(std::move(filled)))
          << fill << " in " << share;
    }
}

TEST(Screening, FindsAFarValueThatStandsInLongerStretches) {
  for (const Index rows : {3, 10, 30}) {
    Telemetry telemetry;
    TickSet filled;
    for (Index t = 1'000; t < 30'000; t += 40 * rows) {
      telemetry.channel(Telemetry::battery).segment(t, std::min(rows, 30'000 - t)).setConstant(0);
      filled.push_back({t, std::min<Index>(t + rows, 30'000)});
    }
    EXPECT_EQ(ticks_of(telemetry.faults(), SensorFaultKind::fill, Telemetry::battery), filled)
        << rows;
  }
}

TEST(Screening, AnInputThatIsOffForAMomentWhileAnOutputTurnsHoldsNoFillValue) {
  // A slow output, which a step of the input turns and does not make jump.
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  Matrix u(20'000, 1), y(20'000, 1);
  double state = 0;
  for (Index t = 0; t < 20'000; ++t) {
    u(t, 0) = t % 400 < 20 ? 0 : 5 + 0.1 * noise(random);
    y(t, 0) = state + 0.01 * noise(random);
    state += (u(t, 0) - state) / 500;
  }
  EXPECT_TRUE(sensor_faults(contiguous_record(1, u, y), {true, true}).empty());
}

TEST(Screening, FindsOneImpossibleValueInAnInputOfTwoLevels) {
  for (const double value : {9999.0, -999.0, 1e30}) {
    std::mt19937 random(8);
    std::normal_distribution<double> noise;
    Matrix u(1'200, 1), y(1'200, 1);
    double state = 0;
    for (Index t = 0; t < 1'200; ++t) {
      u(t, 0) = random() % 2 == 0 ? 27 : 29;
      y(t, 0) = state + 0.01 * noise(random);
      state = 0.8 * state + u(t, 0);
    }
    u(180, 0) = value;
    EXPECT_EQ(
        ticks_of(sensor_faults(contiguous_record(1, u, y), {true, true}), SensorFaultKind::fill, 0),
        (TickSet{{180, 181}}))
        << value;
  }
}

TEST(Screening, FindsRowsThatWereHeldInAllChannelsWhereNoiseNeverRests) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise;
  Matrix u(1'000, 1), y(1'000, 1);
  for (Index t = 0; t < 1'000; ++t) {
    u(t, 0) = t > 0 ? 0.9 * u(t - 1, 0) + noise(random) : 0;
    y(t, 0) = t > 0 ? 0.5 * y(t - 1, 0) + u(t - 1, 0) + 0.1 * noise(random) : 0;
  }
  for (Index t = 301; t < 340; ++t) u.row(t) = u.row(300), y.row(t) = y.row(300);
  const auto faults = sensor_faults(contiguous_record(1, u, y), {true, true});
  for (const Index c : {0, 1})
    EXPECT_EQ(ticks_of(faults, SensorFaultKind::stuck, c), (TickSet{{300, 340}})) << c;
}

TEST(Screening, WhatIsOffWhereAnotherSensorJumpsOrForLongIsNoFillValue) {
  Telemetry together, long_off;
  for (Index t = 0; t < 30'000; ++t) {
    if (t % 40 == 7) {
      together.channel(Telemetry::load)(t) = 0;
      together.channel(Telemetry::battery)(t) += 6;
    }
    if (t / 60 % 5 == 1) long_off.channel(Telemetry::load)(t) = 0;
  }
  EXPECT_TRUE(together.faults().empty());
  EXPECT_TRUE(long_off.faults().empty());
}

TEST(Screening, AnEquipmentThatIsSwitchedOnIsNoFillValue) {
  Telemetry telemetry;
  std::mt19937 random(6);
  std::normal_distribution<double> noise;
  for (Index t = 0; t < 30'000; ++t)
    telemetry.channel(Telemetry::load)(t) = t / 900 % 3 == 0 ? 2.5 : 0.01 * noise(random);
  EXPECT_TRUE(telemetry.faults().empty());
}

TEST(Screening, FindsAnImpossibleValueBesideALoadStep) {
  for (const Index row : {431 * 3 - 1, 431 * 7, 431 * 7 + 1, 1'700}) {
    Telemetry telemetry;
    telemetry.channel(Telemetry::battery)(row) = 0;
    EXPECT_EQ(ticks_of(telemetry.faults(), SensorFaultKind::spike, Telemetry::battery),
              (TickSet{{row, row + 1}}))
        << row;
  }
}

TEST(Screening, LeavesPulsesThatAnotherSensorAnswers) {
  for (const double answer : {0.15, 0.4, 2.0}) {
    Telemetry telemetry;
    for (Index t = 200; t < 30'000; t += 700) {
      telemetry.channel(Telemetry::load)(t) += 9;
      telemetry.channel(Telemetry::battery)(t) -= answer;
    }
    for (const SensorFault& fault : telemetry.faults())
      ADD_FAILURE() << answer << ": " << name(fault.kind) << " of " << fault.channel << " at "
                    << fault.ticks.begin;
  }
  Telemetry unanswered;
  for (Index t = 200; t < 30'000; t += 700) unanswered.channel(Telemetry::load)(t) += 9;
  EXPECT_EQ(ticks_of(unanswered.faults(), SensorFaultKind::spike, Telemetry::load).size(), 43U);
}

TEST(Screening, FindsValuesThatAreAnythingInSomeOfAHundredRows) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform;
  for (const double share : {0.01, 0.03, 0.06}) {
    Telemetry telemetry;
    const auto spoil = [&](Index channel, double low, double high) {
      std::vector<bool> spoilt(30'000);
      for (Index t = 0; t < 30'000; ++t)
        if (uniform(random) < share) {
          telemetry.channel(channel)(t) = low + (high - low) * uniform(random);
          spoilt[static_cast<std::size_t>(t)] = true;
        }
      return spoilt;
    };
    const auto load = spoil(Telemetry::load, 0, 20), battery = spoil(Telemetry::battery, 40, 60);
    const auto faults = telemetry.faults();
    for (const auto& [channel, spoilt] :
         {std::pair(Telemetry::load, load), std::pair(Telemetry::battery, battery)}) {
      std::array<double, 2> found{};  // honest and spoilt rows
      for (const TickRange& ticks : ticks_of(faults, SensorFaultKind::spike, channel))
        for (std::int64_t t = ticks.begin; t < ticks.end; ++t)
          ++found[spoilt[static_cast<std::size_t>(t)] ? 1 : 0];
      const auto all = double(std::ranges::count(spoilt, true));
      EXPECT_GT(found[1], 0.6 * all) << share;
      EXPECT_LT(found[0], 0.02 * all) << share;
    }
  }
}

TEST(Screening, LeavesPulsesOfAnyHeightThatAnotherSensorAnswers) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform;
  for (const double share : {0.01, 0.03, 0.06}) {
    Telemetry telemetry;
    for (Index t = 0; t < 30'000; ++t)
      if (uniform(random) < share) {
        const double height = 2 + 10 * uniform(random);
        telemetry.channel(Telemetry::load)(t) += height;
        telemetry.channel(Telemetry::battery)(t) -= 0.05 * height;
      }
    EXPECT_TRUE(telemetry.faults().empty()) << share;
  }
}

TEST(Screening, FindsSeveralFrozenStretchesOfANoisySensor) {
  for (const Index rows : {25, 40, 300}) {
    Telemetry telemetry;
    std::vector<TickRange> frozen;
    for (const Index begin : {1'200, 8'000, 13'000, 20'000}) {
      auto values = telemetry.channel(Telemetry::battery);
      values.segment(begin, rows).setConstant(values(begin));
      frozen.push_back({begin, begin + rows});
    }
    const TickSet found = ticks_of(telemetry.faults(), SensorFaultKind::stuck, Telemetry::battery);
    ASSERT_EQ(found.size(), 4U) << rows;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(double(found[i].begin), double(frozen[i].begin), 3);
      EXPECT_NEAR(double(found[i].end), double(frozen[i].end), 3);
    }
  }
}

TEST(Screening, FindsAFrozenStretchAtAnEndWhereTheSensorIsNoisyAtOtherTimes) {
  Telemetry telemetry;
  std::mt19937 random(8);
  std::normal_distribution<double> noise;
  auto values = telemetry.channel(Telemetry::load);
  for (Index t = 0; t < 30'000; ++t)
    values(t) = quantised(5 + double(t / 431 % 3) + 0.01 * noise(random), 0.002);
  const Index begin = 431 * 8 + 100;  // the highest of its levels
  values.segment(begin, 40).setConstant(values(begin));
  const TickSet found = ticks_of(telemetry.faults(), SensorFaultKind::stuck, Telemetry::load);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(double(found[0].begin), double(begin), 3);
  EXPECT_NEAR(double(found[0].end), double(begin + 40), 3);
}

TEST(Screening, LeavesAPanelThatHasNothingToShowInEclipse) {
  Telemetry telemetry;
  // The least value differs by a digit from eclipse to eclipse.
  for (Index t = 0; t < 30'000; ++t)
    if (double(t % 6'000) / 6'000 > 0.65)
      telemetry.channel(Telemetry::array)(t) = 0.02 * double(t / 6'000 % 3);
  EXPECT_TRUE(telemetry.faults().empty());
}

TEST(Screening, LeavesTheOneEclipseOfAPanelWhereOtherRowsAreBelowIt) {
  for (const Index rows : {1, 100}) {
    Telemetry telemetry(1, 6'000);
    std::mt19937 random(2);
    std::normal_distribution<double> noise;
    for (Index t = 1'000; t < 1'000 + rows; ++t)
      telemetry.channel(Telemetry::array)(t) = -20 + 5 * noise(random);
    for (const SensorFault& fault : telemetry.faults()) {
      EXPECT_NE(fault.kind, SensorFaultKind::stuck) << rows;
      EXPECT_EQ(fault.channel, Telemetry::array) << rows;
    }
  }
}

TEST(Screening, FindsANumberOfNinesThatNoOtherValueLiesNear) {
  // The currents of a panel from 0 to 1300 mA, each sent for three rows.
  for (const double share : {0.01, 0.1, 0.5}) {
    Telemetry telemetry;
    auto values = telemetry.channel(Telemetry::array);
    std::mt19937 random(3);
    std::bernoulli_distribution is_filled(share);
    for (Index t = 0; t < 30'000; ++t) values(t) = t % 3 == 0 ? 100 * values(t) : values(t - t % 3);
    Index filled = 0;
    for (Index t = 0; t < 30'000; ++t)
      if (is_filled(random)) values(t) = -999, ++filled;
    EXPECT_EQ(size(ticks_of(telemetry.faults(), SensorFaultKind::fill, Telemetry::array)), filled);
    EXPECT_TRUE(ticks_of(telemetry.faults(), SensorFaultKind::stuck, Telemetry::array).empty());
  }
}

TEST(Screening, LooksAtAnalogChannelsAlone) {
  Telemetry telemetry;
  telemetry.channel(Telemetry::load)(1'000) += 9;
  EXPECT_TRUE(sensor_faults(telemetry.record, {true, false, true, true, true}).empty());
  EXPECT_TRUE(sensor_faults(Record{1, Matrix(0, 1), Matrix(0, 1), {}}, {true, true}).empty());
}

}  // namespace
}  // namespace reident::identification::sensor_screening_test
