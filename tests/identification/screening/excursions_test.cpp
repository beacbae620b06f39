#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "identification/samples/tick_ranges.hpp"
#include "identification/screening/sensor_screening.hpp"

namespace reident::identification::excursions_test {
namespace {

using Rows = std::vector<Index>;

/// A load that steps, a temperature, and a bus voltage that follows both slowly.
struct Bus {
  Index rows;
  std::mt19937 random;
  std::normal_distribution<double> noise;
  Vector load, temperature, voltage;

  explicit Bus(unsigned seed, Index rows_ = 1'200)
      : rows(rows_), random(seed), load(rows), temperature(rows), voltage(rows) {
    double level = 5, warm = 0;
    for (Index t = 0; t < rows; ++t) {
      if (random() % 12 == 0) level = 1 + 8 * uniform();
      warm = 0.9 * warm + 0.13 * noise(random);
      load(t) = level;
      temperature(t) = 2 + warm;
    }
  }

  double uniform() { return std::uniform_real_distribution<double>()(random); }

  /// Rows that are not next to each other, ascending; at choice where the load does not step.
  Rows some_rows(std::size_t count, bool at_any_load = true) {
    Rows all;
    while (all.size() < count) {
      const Index row = 20 + static_cast<Index>(random() % static_cast<unsigned>(rows - 40));
      const auto is_near = [row](Index other) { return std::abs(other - row) < 3; };
      if (std::none_of(all.begin(), all.end(), is_near) &&
          (at_any_load || std::abs(load(row + 1) - load(row - 1)) < 0.1))
        all.push_back(row);
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  /// The voltage answers the load by now; then the sensors add their noise.
  void answer(double pole, double voltage_noise = 0.01) {
    double state = -0.3 * load(0) + 0.5 * temperature(0);
    for (Index t = 0; t < rows; ++t) {
      voltage(t) = 28 + state + voltage_noise * noise(random);
      state = pole * state + (1 - pole) * (-0.3 * load(t) + 0.5 * temperature(t));
      load(t) += 0.01 * noise(random);
    }
  }

  Rows left_out() const {
    Matrix u(rows, 2);
    u << load, temperature;
    return left_out_of(u, voltage, {true, true, true});
  }

  static Rows left_out_of(const Matrix& u, const Matrix& y, const std::vector<bool>& analog) {
    std::vector<TickRange> ticks;
    for (const SensorFault& fault : sensor_faults(contiguous_record(1, u, y), analog))
      if (fault.kind != SensorFaultKind::noise) ticks.push_back(fault.ticks);
    Rows found;
    for (const TickRange& range : united(std::move(ticks)))
      for (std::int64_t t = range.begin; t < range.end; ++t) found.push_back(t);
    return found;
  }
};

std::size_t common(const Rows& some, const Rows& others) {
  Rows both;
  std::set_intersection(some.begin(), some.end(), others.begin(), others.end(),
                        std::back_inserter(both));
  return both.size();
}

TEST(Screening, FindsPacketsThatWereLostInAllChannels) {
  for (const std::size_t count : {1U, 3U, 12U, 48U}) {
    std::size_t honest = 0;
    for (unsigned seed = 1; seed <= 10; ++seed) {
      Bus bus(seed);
      bus.answer(0.92);
      const Rows lost = bus.some_rows(count);
      Matrix u(bus.rows, 3);
      u << bus.load, bus.temperature, Vector::Ones(bus.rows);  // with a status
      for (const Index row : lost) u.row(row).setZero(), bus.voltage(row) = 0;
      const Rows found = Bus::left_out_of(u, bus.voltage, {true, true, false, true});
      EXPECT_EQ(common(found, lost), count) << seed;
      honest += found.size() - common(found, lost);
    }
    EXPECT_LE(honest, 6U) << count;
  }
}

TEST(Screening, FindsOneStretchOfLostPackets) {
  for (const Index rows : {2, 7, 20}) {
    Bus bus(3);
    bus.answer(0.92);
    bus.load.segment(700, rows).setZero();
    bus.temperature.segment(700, rows).setZero();
    bus.voltage.segment(700, rows).setZero();
    const Rows found = bus.left_out();
    for (Index row = 700; row < 700 + rows; ++row)
      EXPECT_EQ(std::count(found.begin(), found.end(), row), 1) << row;
  }
}

TEST(Screening, AHeaterThatIsOffWithItsCommandWasNotLost) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise;
  Matrix u(2'000, 2), y(2'000, 1);
  for (Index t = 0; t < 2'000; ++t) {
    u(t, 0) = t % 97 == 0 ? 0 : 1;
    u(t, 1) = u(t, 0) > 0 ? 1.5 + 0.02 * noise(random) : 0;
    y(t, 0) = 20 + noise(random);
  }
  EXPECT_TRUE(Bus::left_out_of(u, y, {false, true, true}).empty());
}

TEST(Screening, FindsAValueThatIsRepeatedForSingleRowsWhereverItLies) {
  for (const double value : {0.0, 1.0, 5.0})  // outside of the load's 1 to 9 and inside
    for (const double share : {0.03, 0.08})
      for (unsigned seed = 1; seed <= 5; ++seed) {
        Bus bus(seed, 2'000);
        bus.answer(0.9);
        const Rows filled = bus.some_rows(static_cast<std::size_t>(share * 2'000));
        for (const Index row : filled) bus.load(row) = value;
        const Rows found = bus.left_out();
        EXPECT_EQ(common(found, filled), filled.size()) << value << ' ' << share << ' ' << seed;
        EXPECT_LE(found.size(), filled.size() + 4) << value << ' ' << share << ' ' << seed;
      }
}

TEST(Screening, FindsAValueThatTwoInputsHaveInRowsOfTheirOwn) {
  int right = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Bus bus(seed);
    bus.answer(0.92);
    Rows lost;
    for (Index t = 0; t < bus.rows; ++t) {
      const bool has_load = bus.uniform() > 0.15, has_temperature = bus.uniform() > 0.15;
      if (!has_load) bus.load(t) = -1;
      if (!has_temperature) bus.temperature(t) = -1;
      if (!has_load || !has_temperature) lost.push_back(t);
    }
    right += bus.left_out() == lost ? 1 : 0;
  }
  EXPECT_GE(right, 8);
}

TEST(Screening, LeavesARepeatedValueThatTheOutputAnswers) {
  for (const double pole : {0.5, 0.9, 0.97})
    for (const std::size_t count : {10U, 50U, 150U}) {
      Bus bus(static_cast<unsigned>(count), 2'000);
      const Rows off = bus.some_rows(count);
      for (const Index row : off) bus.load(row) = 0;
      bus.answer(pole);
      for (const Index row : off) bus.load(row) = 0;
      EXPECT_LE(bus.left_out().size(), 2U) << pole << ' ' << count;
    }
}

TEST(Screening, LeavesAPanelThatIsDarkForLongAndForMoments) {
  Bus bus(5, 3'000);
  for (Index t = 0; t < bus.rows; ++t)
    bus.load(t) =
        t % 95 < 60 ? 6 + 0.5 * std::sin(double(t % 95) / 20) + 0.02 * bus.noise(bus.random) : 0;
  bus.answer(0.97);
  for (Index t = 0; t < bus.rows; ++t)
    if (t % 95 >= 60 || t % 380 == 30) bus.load(t) = 0;
  for (const Index row : bus.left_out()) EXPECT_EQ(row % 380, 30);
}

TEST(Screening, LeavesPulsesOfManyHeightsOfWhichSomeRepeat) {
  // A discharge in pulses: on in every other row, to a digit that the noise repeats.
  std::mt19937 random(6);
  std::normal_distribution<double> noise;
  Matrix u(3'000, 1), y(3'000, 1);
  for (Index t = 0; t < 3'000; ++t) {
    const bool is_pulsed = t / 300 % 2 == 1;
    u(t, 0) = std::round((is_pulsed && t % 2 == 0 ? -4.02
                          : is_pulsed             ? 0
                                                  : 1.51) *
                             1e3 +
                         noise(random)) /
              1e3;
    y(t, 0) = 3.5 + noise(random);
  }
  EXPECT_TRUE(Bus::left_out_of(u, y, {true, true}).empty());
}

TEST(Screening, LeavesFewPulsesThatASlowOutputAnswers) {
  for (const double pole : {0.7, 0.95}) {
    std::size_t left_out = 0, all = 0;
    for (unsigned seed = 1; seed <= 20; ++seed)
      for (const std::size_t count : {2U, 5U}) {
        Bus bus(seed, 1'500);
        const Rows pulses = bus.some_rows(count);
        for (const Index row : pulses) bus.load(row) += 4 + 3 * bus.uniform();
        bus.answer(pole, 0.005);
        left_out += common(bus.left_out(), pulses);
        all += count;
      }
    EXPECT_LE(double(left_out), 0.05 * double(all)) << pole;
  }
}

TEST(Screening, LeavesPulsesOfALoadThatIsQuietOtherwise) {
  std::size_t left_out = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Bus bus(seed, 1'500);
    bus.load.setConstant(1);
    const Rows pulses = bus.some_rows(5);
    for (const Index row : pulses) bus.load(row) += 2 + 4 * bus.uniform();
    bus.answer(0.95);
    left_out += common(bus.left_out(), pulses);
  }
  EXPECT_LE(left_out, 5U);
}

TEST(Screening, FindsAnImpossibleValueAmongPulsesThatTheOutputAnswers) {
  std::size_t found = 0, left_out = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Bus bus(seed, 1'500);
    const Rows pulses = bus.some_rows(5);
    for (const Index row : pulses) bus.load(row) += 4 + 3 * bus.uniform();
    bus.answer(0.95, 0.005);
    Index wrong = 700;
    while (std::abs(*std::lower_bound(pulses.begin(), pulses.end() - 1, wrong - 3) - wrong) < 4)
      ++wrong;
    bus.load(wrong) += 60;
    const Rows faults = bus.left_out();
    found += common(faults, {wrong});
    left_out += common(faults, pulses);
  }
  EXPECT_GE(found, 19U);  // one lies on a step of the load
  EXPECT_LE(left_out, 5U);
}

TEST(Screening, LeavesPeaksOfAFastOutputWhoseInputStepsTwiceInAFewRows) {
  int left_out = 0, found = 0;
  for (const Index delay : {1, 9})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Bus bus(seed, 2'000);
      Matrix u(bus.rows, 1), y(bus.rows, 1);
      double level = 1, state = 0;
      for (Index t = 0; t < bus.rows; ++t) {
        if (bus.random() % 10 == 0) level = bus.uniform();
        u(t) = level;
      }
      for (Index t = 0; t < bus.rows; ++t) {
        state = 0.4 * state + 0.6 * u(std::max<Index>(t - delay, 0));
        y(t) = 5 + state + 0.003 * bus.noise(bus.random);
      }
      left_out += Bus::left_out_of(u, y, {true, true}).empty() ? 0 : 1;
      y(1'000) += 3;
      const Rows rows = Bus::left_out_of(u, y, {true, true});
      found += std::ranges::count(rows, 1'000) > 0 ? 1 : 0;
    }
  EXPECT_LE(left_out, 2);
  EXPECT_GE(found, 39);
}

TEST(Screening, FindsFewPulsesThatNoOutputAnswers) {
  for (const double pole : {0.7, 0.95}) {
    std::size_t found = 0, all = 0, honest = 0;
    for (unsigned seed = 1; seed <= 20; ++seed)
      for (const std::size_t count : {2U, 5U}) {
        Bus bus(seed, 1'500);
        bus.answer(pole, 0.005);
        const Rows pulses = bus.some_rows(count, false);
        for (const Index row : pulses) bus.load(row) += 4 + 3 * bus.uniform();
        const Rows left_out = bus.left_out();
        found += common(left_out, pulses);
        honest += left_out.size() - common(left_out, pulses);
        all += count;
      }
    EXPECT_GE(double(found), 0.95 * double(all)) << pole;
    EXPECT_LE(honest, 10U) << pole;
  }
}

TEST(Screening, LeavesAPulseThatTheOutputAnswersWhereItIsStuckAtOtherTimes) {
  std::size_t left_out = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Bus bus(seed, 1'500);
    bus.load(1'000) += 5;
    bus.answer(0.9, 0.005);
    for (const Index row : {200, 600}) {
      bus.load.segment(row, 50).setConstant(bus.load(row));
      bus.voltage.segment(row, 50).setConstant(bus.voltage(row));
    }
    left_out += common(bus.left_out(), {1'000});
  }
  EXPECT_LE(left_out, 1U);
}

TEST(Screening, TheWayBackBetweenTwoSpikesIsNoSpike) {
  Bus bus(7);
  bus.answer(0.9);
  bus.voltage(500) += 5;
  bus.voltage(502) += 5;
  EXPECT_EQ(bus.left_out(), (Rows{500, 502}));
}

}  // namespace
}  // namespace reident::identification::excursions_test
