// Faults of single sensors while the equipment steps all the time, and rows in which it rests.
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "identification/samples/tick_ranges.hpp"
#include "identification/screening/sensor_screening.hpp"

namespace reident::identification::stepped_load_test {
namespace {

double quantised(double value, double step) {
  return std::round(value / step) * step;
}

/// A load in levels from 2 to 7 A that hold some 8 rows, with noise, and a bus that answers it.
struct SteppedLoad {
  Record record{1, Matrix(700, 1), Matrix(700, 1), {{0, 700, 0}}};
  std::mt19937 random;

  explicit SteppedLoad(unsigned seed) : random(seed) {
    std::normal_distribution<double> noise;
    std::uniform_real_distribution<double> level(2, 7);
    double load = level(random), state = 0;
    for (Index t = 0; t < 700; ++t) {
      if (random() % 8 == 0) load = level(random);
      record.u(t) = quantised(load + 0.01 * noise(random), 0.001);
      record.y(t) = quantised(28.2 - state + 0.01 * noise(random), 0.001);
      state += 0.07 * (0.25 * load - state);
    }
  }
  TickSet found(SensorFaultKind kind, Index channel) const {
    std::vector<TickRange> ticks;
    for (const SensorFault& fault : sensor_faults(record, {true, true}))
      if (fault.kind == kind && fault.channel == channel) ticks.push_back(fault.ticks);
    return united(std::move(ticks));
  }
};

TEST(ScreeningOfSteps, FindsABusAtZeroInStretchesWhileTheLoadStepsAllTheTime) {
  int right = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    std::vector<TickRange> zeros;
    for (const Index begin : {60, 230, 240, 410, 633}) {
      const auto rows = static_cast<Index>(6 + telemetry.random() % 7);
      telemetry.record.y.middleRows(begin, rows).setZero();
      zeros.push_back({begin, begin + rows});
    }
    right += telemetry.found(SensorFaultKind::fill, 1) == united(std::move(zeros));
  }
  EXPECT_GE(right, 19);
}

TEST(ScreeningOfSteps, FindsABusAtZeroInTwoOfFiveRows) {
  int right = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    std::bernoulli_distribution is_lost(0.4);
    std::vector<TickRange> zeros;
    for (Index row = 0; row < 700; ++row)
      if (is_lost(telemetry.random)) {
        telemetry.record.y(row) = 0;
        zeros.push_back({row, row + 1});
      }
    right += telemetry.found(SensorFaultKind::fill, 1) == united(std::move(zeros));
  }
  EXPECT_GE(right, 19);
}

TEST(ScreeningOfSteps, FindsAThirdValueInSingleRowsOfACommandOfTwoLevels) {
  int found = 0, left_out = 0;
  for (const double value : {-1.0, 2.0})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      SteppedLoad telemetry(seed);
      Record& record = telemetry.record;
      std::normal_distribution<double> noise;
      double heater = 0, cold = 0, warm = 0;
      Record answering = record;
      for (Index t = 0; t < 700; ++t) {
        if (telemetry.random() % 20 == 0) heater = 1 - heater;
        record.u(t) = answering.u(t) = telemetry.random() % 20 == 0 ? value : heater;
        record.y(t) = 20 + cold + 0.02 * noise(telemetry.random);
        answering.y(t) = 20 + warm + 0.02 * noise(telemetry.random);
        cold = 0.9 * cold + 0.1 * heater;
        warm = 0.9 * warm + 0.1 * answering.u(t);
      }
      const auto is_found = [](const Record& in) {
        return !sensor_faults(in, {false, true}).empty();
      };
      found += is_found(record) ? 1 : 0;
      left_out += is_found(answering) ? 1 : 0;
    }
  EXPECT_GE(found, 38);
  EXPECT_LE(left_out, 2);
}

TEST(ScreeningOfSteps, LeavesALoadThatIsOffForMomentsWhichASlowBusAnswers) {
  int left_out = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    std::normal_distribution<double> noise;
    double state = 0;
    bool is_on = true;
    for (Index t = 0; t < 700; ++t) {
      is_on = telemetry.random() % (is_on ? 4 : 2) == 0 ? !is_on : is_on;
      telemetry.record.u(t) = is_on ? 20 + 0.5 * noise(telemetry.random) : 0;
      telemetry.record.y(t) = 28 + state + 0.3 * noise(telemetry.random);
      state = 0.94 * state - 0.03 * telemetry.record.u(t);
    }
    left_out += telemetry.found(SensorFaultKind::fill, 0).empty() ? 0 : 1;
  }
  EXPECT_LE(left_out, 1);
}

TEST(ScreeningOfSteps, FindsASensorThatIsFrozenNearAnEndOfItsRange) {
  int right = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    telemetry.record.u.middleRows(300, 48).setConstant(6.8);
    right += size(telemetry.found(SensorFaultKind::stuck, 0)) == 48;
  }
  EXPECT_GE(right, 19);
}

TEST(ScreeningOfSteps, FindsAFrozenSensorBesideRowsThatHoldNoSample) {
  int right = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    telemetry.record.y.middleRows(300, 100).setConstant(telemetry.record.y(300));
    for (Index row = 5; row < 695; ++row) {
      if (telemetry.random() % 30 == 0) telemetry.record.u(row) = -999;
      if (telemetry.random() % 60 == 0) telemetry.record.y(row) = -999;
    }
    telemetry.record.y(300) = telemetry.record.y(399) = telemetry.record.y(310);
    right += telemetry.found(SensorFaultKind::stuck, 1) == TickSet{{300, 400}};
  }
  EXPECT_GE(right, 18);
}

TEST(ScreeningOfSteps, FindsShortFrozenStretchesOfASensorThatNeverRepeatsAValue) {
  int right = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    std::normal_distribution<double> noise(0, 0.01);
    for (double& value : telemetry.record.y.reshaped()) value += noise(telemetry.random);
    TickSet frozen;
    for (const Index begin : {70, 150, 300, 420, 600}) {
      const auto rows = static_cast<Index>(8 + telemetry.random() % 12);
      telemetry.record.y.middleRows(begin, rows).setConstant(telemetry.record.y(begin));
      frozen.push_back({begin, begin + rows});
    }
    right += telemetry.found(SensorFaultKind::stuck, 1) == frozen;
  }
  EXPECT_GE(right, 18);
}

TEST(ScreeningOfSteps, LeavesAnOutputWithoutNoiseThatTurns) {
  for (Index rows = 400; rows < 1'400; rows += 50) {
    Record record{1, Matrix(rows, 1), Matrix(rows, 1), {{0, rows, 0}}};
    for (Index t = 0; t < rows; ++t) {
      record.u(t) = quantised(std::sin(4.0 * double(t) / double(rows)), 1e-5);
      record.y(t) = quantised(20 + std::sin(4.0 * double(t - 9) / double(rows)), 2e-4);
    }
    EXPECT_TRUE(sensor_faults(record, {true, true}).empty()) << rows;
  }
}

TEST(ScreeningOfSteps, LeavesInputsAndOutputsThatCameToRest) {
  for (const double noise : {0.0, 0.02})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      std::mt19937 random(seed);
      std::normal_distribution<double> normal;
      Record record{1, Matrix(400, 2), Matrix(400, 1), {{0, 400, 0}}};
      for (double& value : record.u.reshaped()) value = normal(random);
      record.u.bottomRows(150).rowwise() = record.u.row(250).eval();
      double state = 0;
      for (Index t = 0; t < 400; ++t) {
        record.y(t) = quantised(5 + state + noise * normal(random), 0.001);
        state = 0.7 * state + record.u(t, 0) + 0.3 * record.u(t, 1);
      }
      EXPECT_TRUE(sensor_faults(record, {true, true, true}).empty()) << noise << " " << seed;
    }
}

TEST(ScreeningOfSteps, LeavesAnOutputWithoutNoiseThatRestsAtFirstOrBetweenSteps) {
  for (const Index rest : {0, 200})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> level(0, 5);
      Record record{1, Matrix(600, 1), Matrix(600, 1), {{0, 600, 0}}};
      double input = level(random), state = 0.1 * input / (1 - 0.9);
      for (Index t = 0; t < 600; ++t) {
        if (random() % 15 == 0 && (t < rest || t >= rest + 200)) input = level(random);
        record.u(t) = quantised(input, 0.01);
        record.y(t) = quantised(20 + state, 1e-5);
        state = 0.9 * state + 0.1 * record.u(t);
      }
      EXPECT_TRUE(sensor_faults(record, {true, true}).empty()) << rest << " " << seed;
    }
}

TEST(ScreeningOfSteps, FindsAnImpossibleInputWhereItSteps) {
  int right = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SteppedLoad telemetry(seed);
    auto& load = telemetry.record.u;
    Index row = 100;
    while (std::abs(load(row) - load(row - 1)) < 2) ++row;
    load(row) = 480;
    const TickSet found = telemetry.found(SensorFaultKind::spike, 0);
    right += std::ranges::count(found, TickRange{row, row + 1}) > 0;
  }
  EXPECT_GE(right, 49);
}

TEST(ScreeningOfSteps, LeavesAnInputThatStepsMoreOftenForAWhile) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    Record record{1, Matrix(1'800, 1), Matrix(1'800, 1), {{0, 1'800, 0}}};
    double input = 0, state = 0;
    for (Index t = 0; t < 1'800; ++t) {
      const bool is_often = t >= 400 && t < 680;
      if (t % (is_often ? 5 : 40) == 0) input = double(random() % 1'000) / 200;
      record.u(t) = input;
      record.y(t) = 20 + state + 0.05 * noise(random);
      state = 0.9 * state + 0.1 * input;
    }
    EXPECT_TRUE(sensor_faults(record, {true, true}).empty()) << seed;
    for (Index t = 400; t < 680; ++t) record.u(t) += noise(random);
    const auto faults = sensor_faults(record, {true, true});
    EXPECT_TRUE(std::ranges::any_of(
        faults, [](const auto& fault) { return fault.kind == SensorFaultKind::noise; }));
  }
}

TEST(ScreeningOfSteps, LeavesANoisySensorThatIsSaturatedForLongOnce) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SteppedLoad telemetry(seed);
    telemetry.record.u.middleRows(300, 48).setConstant(7.5);
    EXPECT_TRUE(telemetry.found(SensorFaultKind::stuck, 0).empty()) << seed;
  }
}

}  // namespace
}  // namespace reident::identification::stepped_load_test
