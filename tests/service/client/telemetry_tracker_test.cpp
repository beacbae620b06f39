#include "service/client/telemetry_tracker.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>

#include "identification/samples/grid.hpp"
#include "tests/service/client/live_telemetry.hpp"

namespace reident::test::telemetry_tracker_test {
namespace {

using storage::Quality;

constexpr storage::Time second = 1'000'000'000;

class Tracker : public testing::Test {
 protected:
  Tracker() { describe_all(tracker_); }

  /// Two inputs and an output, all at once.
  void add(storage::Time time, double u1, double u2, double y, Quality quality = Quality::good) {
    add(frame_at(time, {{1, quality, u1}, {2, Quality::good, u2}, {3, Quality::good, y}}));
  }
  void add(const storage::TelemetryFrame& frame) {
    tracker_.add(frame, [this](const Tick& tick) { ticks_.push_back(tick); });
  }
  std::vector<std::int64_t> numbers() const {
    std::vector<std::int64_t> result;
    for (const Tick& tick : ticks_) result.push_back(tick.number);
    return result;
  }

  TelemetryTracker tracker_{example_model()};  // 1 s period, 3 s sample hold
  std::vector<Tick> ticks_;
};

TEST_F(Tracker, GivesATickOutOnceALaterFrameHasCome) {
  add(10 * second, 1, 2, 3);
  EXPECT_THAT(ticks_, testing::IsEmpty());
  add(11 * second, 4, 5, 6);
  ASSERT_EQ(numbers(), std::vector<std::int64_t>{10});
  EXPECT_EQ(ticks_[0].u(0), 1);
  EXPECT_EQ(ticks_[0].u(1), 2);
  EXPECT_EQ(ticks_[0].y(0), 3);
}

TEST_F(Tracker, GathersATickFromSeveralFramesOfItsTime) {
  add(frame_at(10 * second, {{1, Quality::good, 1}}));
  add(frame_at(10 * second, {{2, Quality::good, 2}, {3, Quality::good, 3}}));
  add(frame_at(10 * second + 1, {}));
  ASSERT_EQ(ticks_.size(), 1U);
  EXPECT_EQ(ticks_[0].u(1), 2);
}

TEST_F(Tracker, HoldsAValueForTheHoldAndNoLonger) {
  add(10 * second, 1, 2, 3);
  add(frame_at(20 * second, {}));
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{10, 11, 12}));
}

TEST_F(Tracker, ABadInputEndsTheHoldOfTheGoodOneBeforeIt) {
  add(10 * second, 1, 2, 3);
  add(11 * second, 1, 2, 3, Quality::suspect);
  add(12 * second, std::numeric_limits<double>::quiet_NaN(), 2, 3);
  add(13 * second, 1, 2, 3, Quality::out_of_limits);
  add(14 * second, 1, 2, 3);
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{10, 13}));
}

TEST_F(Tracker, StepsWhereTheQualityIsUsable) {
  std::vector<std::int64_t> usable;
  std::int64_t tick = 10;
  for (const Quality quality : storage::qualities) {
    add(tick * second, 1, 2, 3, quality);
    if (storage::is_usable(quality)) usable.push_back(tick);
    ++tick;
  }
  add(tick * second, 1, 2, 3);
  EXPECT_EQ(numbers(), usable);
}

TEST_F(Tracker, AMissingOutputIsNotANumberAndHoldsNothingUp) {
  add(frame_at(10 * second, {{1, Quality::good, 1}, {2, Quality::good, 2}}));
  add(frame_at(11 * second, {}));
  ASSERT_EQ(ticks_.size(), 1U);
  EXPECT_TRUE(std::isnan(ticks_[0].y(0)));
}

TEST_F(Tracker, AFrameOutOfOrderStillCountsForTicksNotGivenOut) {
  add(10 * second, 1, 2, 3);
  add(11 * second + 2, 7, 8, 9);
  add(11 * second, 4, 5, 6);
  add(11 * second + 1, 6, 5, 6);
  add(12 * second + 1, 0, 0, 0);
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{10, 11, 12}));
  EXPECT_EQ(ticks_[2].u(0), 7) << "the latest sample before tick 12";
}

TEST_F(Tracker, IgnoresOtherSpacecraftAndSimulatedTelemetry) {
  auto other = frame_at(10 * second, {{1, Quality::good, 1}, {2, Quality::good, 2}});
  other.spacecraft = "CBERS4A";
  add(other);
  other.spacecraft = "CBERS4";
  other.origin = storage::Origin::simulated;
  add(other);
  add(frame_at(12 * second, {}));
  EXPECT_THAT(ticks_, testing::IsEmpty());
}

TEST_F(Tracker, AGapOfYearsCostsNothingAndIsLeftOut) {
  add(10 * second, 1, 2, 3);
  add(1'000'000'000 * second, 1, 2, 3);
  add(1'000'000'001 * second, 1, 2, 3);
  EXPECT_EQ(numbers(), (std::vector<std::int64_t>{10, 11, 12, 1'000'000'000}));
}

TEST_F(Tracker, GoesOnAfterOneFrameFromTheFarFuture) {
  add(10 * second, 1, 2, 3);
  add(500'000 * second, 1, 2, 3);
  ticks_.clear();
  for (int i = 11; i < 60; ++i) add(i * second, i, 2, 3);
  ASSERT_FALSE(ticks_.empty());
  EXPECT_EQ(ticks_.back().number, 58);
  EXPECT_EQ(ticks_.back().u(0), 58);
  EXPECT_GE(tracker_.counters().clock_jumps, 1U);
}

TEST_F(Tracker, AFewOldFramesAmongLiveOnesAreLateAndChangeNothing) {
  for (int i = 1000; i < 1100; ++i) {
    add(i * second, i, 2, 3);
    add((i - 900) * second, -1, -1, -1);
  }
  EXPECT_EQ(ticks_.size(), 99U);
  EXPECT_EQ(tracker_.counters().clock_jumps, 0U);
  EXPECT_EQ(tracker_.counters().late, 300U);
  for (const Tick& tick : ticks_) EXPECT_EQ(tick.u(0), static_cast<double>(tick.number));
}

TEST_F(Tracker, SurvivesTimesAtTheEndsOf64Bits) {
  add(std::numeric_limits<storage::Time>::max(), 1, 2, 3);
  add(std::numeric_limits<storage::Time>::min(), 1, 2, 3);
  add(10 * second, 1, 2, 3);
  add(11 * second, 1, 2, 3);
  EXPECT_EQ(numbers(), std::vector<std::int64_t>{10});
  EXPECT_EQ(tracker_.counters().clock_jumps, 2U);
}

TEST(TrackerNames, FollowTheDescriptors) {
  TelemetryTracker tracker(example_model());
  EXPECT_THAT(tracker.undescribed(), testing::ElementsAre("I_BDRIN1", "I_BDRIN2", "I_BDROUT"));
  describe_all(tracker);
  EXPECT_THAT(tracker.undescribed(), testing::IsEmpty());
  tracker.describe({"CBERS4", 77, "I_BDRIN1", "A", "", storage::ParameterKind::analog, {}, {}});
  std::vector<Tick> ticks;
  const auto keep = [&](const Tick& tick) { ticks.push_back(tick); };
  tracker.add(frame_at(second, {{77, Quality::good, 5}, {2, Quality::good, 6}}), keep);
  tracker.add(frame_at(2 * second, {}), keep);
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0].u(0), 5);
}

TEST(TrackerGrid, IsThatOfTheIdentification) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    EquipmentModel model = example_model();
    model.outputs.clear();
    model.dynamics.period_s = 0.5;
    model.sample_hold_ns = 1'200'000'000;
    const storage::Time phase = trial % 2 == 0 ? 0 : second / 5;
    if (phase > 0) model.phase_ns = phase;
    TelemetryTracker tracker(model);
    describe_all(tracker);
    std::array<std::vector<storage::Time>, 2> times;
    std::array<std::vector<double>, 2> values;
    std::array<std::vector<std::uint8_t>, 2> usable;
    std::vector<Tick> ticks;
    storage::Time time = -20 * second + static_cast<storage::Time>(random() % second);
    const storage::Time begin = time;
    for (int i = 0; i < 200; ++i) {
      time += 1 + static_cast<storage::Time>(random() % (i % 40 == 0 ? 9 * second : second / 2));
      const std::size_t channel = random() % 2;
      const double value = static_cast<double>(i);
      const bool good = random() % 5 != 0;
      times[channel].push_back(time - phase);
      values[channel].push_back(value);
      usable[channel].push_back(good);
      tracker.add(frame_at(time, {{static_cast<std::uint32_t>(channel + 1),
                                   good ? Quality::good : Quality::invalid, value}}),
                  [&](const Tick& tick) { ticks.push_back(tick); });
    }
    const std::vector<identification::ChannelSamples> channels = {{times[0], values[0], usable[0]},
                                                                  {times[1], values[1], usable[1]}};
    const identification::Record record = identification::make_record(
        channels, {}, begin - phase, time - phase,
        {.period_ns = second / 2, .sample_hold_ns = model.sample_hold_ns});
    ASSERT_EQ(static_cast<identification::Index>(ticks.size()), record.u.rows());
    std::size_t i = 0;
    for (const identification::Segment& segment : record.segments) {
      for (identification::Index row = segment.begin; row < segment.end; ++row, ++i) {
        EXPECT_EQ(ticks[i].number, segment.first_tick + (row - segment.begin));
        EXPECT_EQ(ticks[i].u, record.u.row(row).transpose());
      }
    }
  }
}

/// I_BDRIN1 stays; the second input is computed from it and a parameter that is no input.
EquipmentModel derived_model() {
  EquipmentModel model = example_model();
  model.inputs[1] = {"P", "W", 0, 10, "V_BUS * I_BDRIN1 / (I_BDRIN1 - 4)"};
  return model;
}

class DerivedTracker : public testing::Test {
 protected:
  DerivedTracker() {
    describe_all(tracker_);
    storage::ParameterDescriptor bus = example_descriptors()[0];
    bus.id = 9;
    bus.name = "V_BUS";
    tracker_.describe(bus);
  }
  std::vector<Tick> ticks_of(const std::vector<storage::TelemetryFrame>& frames) {
    std::vector<Tick> ticks;
    for (const storage::TelemetryFrame& frame : frames)
      tracker_.add(frame, [&ticks](const Tick& tick) { ticks.push_back(tick); });
    return ticks;
  }

  TelemetryTracker tracker_{derived_model()};
};

TEST_F(DerivedTracker, ComputesAnInputFromItsParameters) {
  const auto ticks =
      ticks_of({frame_at(10 * second,
                         {{1, Quality::good, 5}, {9, Quality::good, 28}, {3, Quality::good, 7}}),
                frame_at(11 * second, {})});
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0].u, (identification::Vector{{5, 140}}));
  EXPECT_EQ(ticks[0].y(0), 7);
}

TEST_F(DerivedTracker, GivesNoTickOutAtWhichAnOperandIsMissingOrTheValueNotFinite) {
  const auto good = Quality::good;
  const auto ticks = ticks_of(
      {frame_at(10 * second, {{1, good, 5}}), frame_at(11 * second, {{1, good, 4}, {9, good, 28}}),
       frame_at(12 * second, {{1, good, 6}}), frame_at(13 * second, {{9, Quality::invalid, 28}}),
       frame_at(14 * second, {})});
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0].number, 12);
  EXPECT_EQ(ticks[0].u(1), 28 * 6 / 2.0);
}

TEST(UndescribedTracker, NamesTheParametersOfAnExpression) {
  const TelemetryTracker tracker(derived_model());
  EXPECT_THAT(tracker.undescribed(), testing::ElementsAre("I_BDRIN1", "V_BUS", "I_BDROUT"));
}

}  // namespace
}  // namespace reident::test::telemetry_tracker_test
