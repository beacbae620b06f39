#include "service/satcs/faults/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <gtest/gtest.h>

#include "tests/service/satcs/faults/faults_fixture.hpp"

namespace reident::satcs::fault_injector_test {
namespace {

using namespace test;
using storage::Quality;
using storage::Sample;
using storage::TelemetryFrame;

/// What becomes of a frame of the range.
struct Fate {
  FaultKind kind;
  std::string text;         // behind the kind's name and the range
  bool by_chance;           // other seeds give other telemetry
  std::size_t least, most;  // how often each frame of the range comes
  double changed;           // share of the samples that differ, at the least
};

const std::vector<Fate>& fates() {
  static const std::vector<Fate> all = {
      {FaultKind::stuck, ":A", false, 1, 1, 0.6},
      {FaultKind::bias_step, ":A*0.5", false, 1, 1, 0.6},
      {FaultKind::drifting_bias, ":A*3", false, 1, 1, 0.6},
      {FaultKind::noise_burst, ":A", true, 1, 1, 0.6},
      {FaultKind::spikes, ":A", true, 1, 1, 0.002},
      {FaultKind::swapped, ":A,B", false, 1, 1, 0.9},
      {FaultKind::wrong_calibration, ":A", false, 1, 1, 0.6},
      {FaultKind::stops, ":A", false, 1, 1, 0},
      {FaultKind::wrong_validity, "", true, 1, 1, 0.1},
      {FaultKind::frames_lost, "", true, 0, 1, 0},
      {FaultKind::passes_lost, "", true, 0, 1, 0},
      {FaultKind::backwards_playback, "", false, 1, 1, 0},
      {FaultKind::two_stations, "", false, 1, 2, 0},
      {FaultKind::two_stamping_stations, "", false, 1, 2, 0},
      {FaultKind::time_jump, "", false, 1, 1, 0},
      {FaultKind::duplicated_day, "*1800", false, 2, 2, 0},
      {FaultKind::repeated_day, "*1800", false, 2, 2, 0},
      {FaultKind::simulated_as_real, "", false, 1, 1, 0},
  };
  return all;
}

std::string text_of(const Fate& fate) {
  return std::string(name(fate.kind)) + fault_range + fate.text;
}

TEST(Faults, AreAllInTheTable) {
  ASSERT_EQ(fates().size(), fault_kinds);
  for (std::size_t k = 0; k < fault_kinds; ++k)
    EXPECT_EQ(fates()[k].kind, static_cast<FaultKind>(k));
}

TEST(Faults, LeaveFramesOutsideTheirRangeAsTheyAre) {
  const auto truth = true_frames();
  for (const Fate& fate : fates()) {
    std::map<std::uint64_t, std::vector<TelemetryFrame>> by_sequence;
    for (auto& frame : received(truth, {fault_of(text_of(fate))}))
      if (frame.source != "simulator") by_sequence[frame.sequence].push_back(std::move(frame));
    for (std::size_t k = 0; k < truth_s; ++k) {
      const auto& came = by_sequence[1000 + k];
      if (k >= from_s && k < to_s) {
        EXPECT_GE(came.size(), fate.least) << text_of(fate) << " " << k;
        EXPECT_LE(came.size(), fate.most) << text_of(fate) << " " << k;
      } else {
        ASSERT_EQ(came.size(), 1U) << text_of(fate) << " " << k;
        EXPECT_TRUE(same(came[0], truth[k])) << text_of(fate) << " " << k;
      }
    }
  }
}

TEST(Faults, ChangeAsManySamplesOfTheirRangeAsTheySay) {
  const auto truth = true_frames();
  for (const Fate& fate : fates()) {
    double samples = 0, changed = 0;
    for (const auto& frame : received(truth, {fault_of(text_of(fate))})) {
      if (frame.source != "station") continue;
      const auto& before = truth[frame.sequence - 1000].samples;
      for (const Sample& sample : frame.samples) {
        const auto was = std::find_if(before.begin(), before.end(), [&](const Sample& one) {
          return one.parameter == sample.parameter;
        });
        const std::size_t k = frame.sequence - 1000;
        if (k < from_s || k >= to_s) continue;
        ++samples;
        changed +=
            was == before.end() || was->value != sample.value || was->quality != sample.quality;
      }
    }
    if (fate.changed > 0) {
      EXPECT_GE(changed, fate.changed * samples) << text_of(fate);
    } else {
      EXPECT_EQ(changed, 0) << text_of(fate);
    }
  }
}

TEST(Faults, AreTheSameForTheSameSeedAlone) {
  // Long enough for passes of which some are lost.
  const auto truth = true_frames(43'200);
  for (const Fate& fate : fates()) {
    const std::string text = std::string(name(fate.kind)) + "@+0s/+12h" + fate.text;
    const auto told = received(truth, {fault_of(text)});
    const auto again = received(truth, {fault_of(text)});
    const auto otherwise = received(truth, {fault_of(text, 2)});
    EXPECT_TRUE(std::equal(told.begin(), told.end(), again.begin(), again.end(), same)) << text;
    EXPECT_EQ(std::equal(told.begin(), told.end(), otherwise.begin(), otherwise.end(), same),
              !fate.by_chance)
        << text;
  }
}

TEST(Faults, AreToldInTheirOrder) {
  const auto truth = true_frames();
  const auto stuck_first = received(truth, {fault_of("stuck" + fault_range + ":A*2"),
                                            fault_of("bias_step" + fault_range + ":A*1")});
  const auto bias_first = received(truth, {fault_of("bias_step" + fault_range + ":A*1"),
                                           fault_of("stuck" + fault_range + ":A*2")});
  EXPECT_EQ(stuck_first[from_s].samples[0].value, 3);
  EXPECT_EQ(bias_first[from_s].samples[0].value, 2);
  // The range of the second one is of the true time all the same.
  const auto jumped = received(truth, {fault_of("time_jump" + fault_range + "*86400"),
                                       fault_of("stops" + fault_range + ":A")});
  EXPECT_EQ(jumped.size(), truth.size());
  for (std::size_t k = from_s; k < to_s; ++k)
    for (const Sample& sample : jumped[k].samples) EXPECT_NE(sample.parameter, a_id);
}

// -- of one sensor

/// What A reads at each second of its range under a fault.
std::vector<double> readings_of_a(const std::string& text) {
  const auto frames = received(true_frames(), {fault_of(text)});
  std::vector<double> values;
  for (std::size_t k = from_s; k < to_s; ++k) values.push_back(frames.at(k).samples.at(0).value);
  return values;
}

TEST(SensorFaults, ReadWhatTheySay) {
  const double span = 40;
  struct Case {
    std::string text;
    std::function<double(double true_value, double passed)> reads;
  };
  const double first = a_at(from_s);
  const auto limited = [](double value) { return std::clamp(value, -10.0, 30.0); };
  for (const auto& [text, reads] : {
           Case{"stuck" + fault_range + ":A", [&](double, double) { return first; }},
           Case{"stuck" + fault_range + ":A*-3.5", [&](double, double) { return -3.5; }},
           Case{"bias_step" + fault_range + ":A",
                [&](double value, double) { return limited(value + 0.02 * span); }},
           Case{"bias_step" + fault_range + ":A*-2.5",
                [&](double value, double) { return limited(value - 2.5); }},
           Case{"drifting_bias" + fault_range + ":A",
                [&](double value, double passed) { return limited(value + 0.05 * span * passed); }},
           Case{"wrong_calibration" + fault_range + ":A",
                [&](double value, double) { return 10 + 1.05 * (value - 10); }},
           Case{"wrong_calibration" + fault_range + ":A*0.9",
                [&](double value, double) { return 10 + 0.9 * (value - 10); }},
       }) {
    const auto values = readings_of_a(text);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double passed = static_cast<double>(k) / static_cast<double>(to_s - from_s);
      EXPECT_NEAR(values[k], reads(a_at(from_s + k), passed), 1e-12) << text << " " << k;
    }
  }
}

TEST(SensorFaults, AddNoiseOfTheirMagnitude) {
  double sum = 0, squares = 0;
  std::size_t count = 0;
  const auto values = readings_of_a("noise_burst" + fault_range + ":A*0.5");
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double error = values[k] - a_at(from_s + k);
    if (std::abs(a_at(from_s + k) - 10) > 17) continue;  // may have met a limit
    sum += error;
    squares += error * error;
    ++count;
  }
  EXPECT_NEAR(sum / static_cast<double>(count), 0, 0.05);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 0.5, 0.03);
}

TEST(SensorFaults, SpikeInOneReadingOfAHundredUpAndDown) {
  std::map<double, int> errors;
  const auto values = readings_of_a("spikes" + fault_range + ":A*4");
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = a_at(from_s + k);
    if (std::abs(value - 10) < 15) ++errors[std::round(values[k] - value)];
  }
  EXPECT_EQ(errors.size(), 3U);
  EXPECT_GT(errors[4], 0);
  EXPECT_GT(errors[-4], 0);
  EXPECT_NEAR((errors[4] + errors[-4]) / 1800.0, 0.01, 0.006);
}

TEST(ParameterFaults, SwapWhatIsThere) {
  const auto truth = true_frames();
  const auto frames = received(truth, {fault_of("swapped" + fault_range + ":A,B")});
  EXPECT_EQ(frames[from_s].samples[0].parameter, b_id);
  EXPECT_EQ(frames[from_s].samples[0].value, truth[from_s].samples[0].value);
  EXPECT_EQ(frames[from_s].samples[1].parameter, a_id);
  // In a frame without B, A comes as B alone.
  EXPECT_EQ(frames[from_s + 1].samples.size(), 1U);
  EXPECT_EQ(frames[from_s + 1].samples[0].parameter, b_id);
}

TEST(ParameterFaults, StopAParameterAndNoFrame) {
  const auto frames = received(true_frames(), {fault_of("stops" + fault_range + ":A")});
  EXPECT_EQ(frames.size(), truth_s);
  EXPECT_EQ(frames[from_s + 1].samples.size(), 0U);
  EXPECT_EQ(frames[from_s + 2].samples[0].parameter, b_id);
}

TEST(ParameterFaults, FlagRightSamplesInvalidAndWrongOnesGood) {
  const auto truth = true_frames();
  auto untrue = truth;
  for (auto& frame : untrue) frame.samples[0].quality = Quality::suspect;
  const auto frames = received(untrue, {fault_of("wrong_validity" + fault_range + ":A*0.5")});
  double invalid = 0, anything = 0;
  for (std::size_t k = from_s; k < to_s; ++k) {
    const Sample& sample = frames[k].samples[0];
    const bool right = sample.value == truth[k].samples[0].value;
    EXPECT_EQ(right, sample.quality != Quality::good);
    EXPECT_TRUE(sample.value >= -10 && sample.value <= 30);
    invalid += sample.quality == Quality::invalid;
    anything += sample.quality == Quality::good;
    for (std::size_t other = 1; other < frames[k].samples.size(); ++other)
      EXPECT_EQ(frames[k].samples[other].value, truth[k].samples[other].value);
  }
  EXPECT_NEAR(invalid / 1800, 0.25, 0.04);
  EXPECT_NEAR(anything / 1800, 0.25, 0.04);
}

}  // namespace
}  // namespace reident::satcs::fault_injector_test
