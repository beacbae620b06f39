#include "service/satcs/lies.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/satcs/handwritten_eps.hpp"
#include "service/satcs/reference_orbit.hpp"

namespace reident::satcs {
namespace {

using storage::Quality;
using storage::Sample;
using storage::TelemetryFrame;
using storage::Time;
using testing::HasSubstr;

constexpr Time second = 1'000'000'000;
constexpr Time start = 1'498'867'200 * second;
constexpr std::uint32_t a_id = 1, b_id = 2, s_id = 3;
constexpr std::size_t truth_s = 3600, from_s = 600, to_s = 2400;  // lies are from 600 s to 2400 s

std::vector<storage::ParameterDescriptor> parameters() {
  std::vector<storage::ParameterDescriptor> three(3);
  for (std::uint32_t k = 0; k < 3; ++k) {
    three[k].id = a_id + k;
    three[k].name.assign(1, "ABS"[k]);
  }
  three[0].low_limit = -10, three[0].high_limit = 30;
  three[1].low_limit = 0, three[1].high_limit = 5;
  three[2].kind = storage::ParameterKind::digital;
  return three;
}

double a_at(std::size_t k) {
  return 10 + 20 * std::sin(0.01 * static_cast<double>(k));
}

/// A at 1 Hz, B every other second, S every tenth.
std::vector<TelemetryFrame> true_frames(std::size_t seconds = truth_s) {
  std::vector<TelemetryFrame> frames(seconds);
  for (std::size_t k = 0; k < seconds; ++k) {
    auto& frame = frames[k];
    frame.source = "station";
    frame.sequence = 1000 + k;
    frame.generation_time = frame.reception_time = start + static_cast<Time>(k) * second;
    frame.samples = {{a_id, Quality::good, a_at(k)}};
    if (k % 2 == 0) frame.samples.push_back({b_id, Quality::good, 2 + 0.001 * a_at(k)});
    if (k % 10 == 0) frame.samples.push_back({s_id, Quality::good, k % 20 == 0 ? 1.0 : 0.0});
  }
  return frames;
}

bool same(const TelemetryFrame& one, const TelemetryFrame& other) {
  return one.source == other.source && one.origin == other.origin &&
         one.sequence == other.sequence && one.generation_time == other.generation_time &&
         one.reception_time == other.reception_time &&
         std::equal(one.samples.begin(), one.samples.end(), other.samples.begin(),
                    other.samples.end(), [](const Sample& a, const Sample& b) {
                      return a.parameter == b.parameter && a.quality == b.quality &&
                             std::bit_cast<std::uint64_t>(a.value) ==
                                 std::bit_cast<std::uint64_t>(b.value);
                    });
}

Lie lie_of(const std::string& text, std::uint64_t seed = 1) {
  auto parsed = parse_lie(text, start);
  if (const auto* error = std::get_if<LieError>(&parsed)) throw std::runtime_error(error->message);
  auto lie = std::get<Lie>(parsed);
  lie.seed = seed;
  return lie;
}

std::vector<TelemetryFrame> received(std::vector<TelemetryFrame> truth,
                                     const std::vector<Lie>& lies) {
  const auto described = parameters();
  Liar liar(lies, described);
  std::vector<TelemetryFrame> frames;
  for (auto& frame : truth) {
    const Time now = frame.generation_time;
    const std::size_t before = frames.size();
    liar.take(std::move(frame), frames);
    for (std::size_t k = before; k < frames.size(); ++k) {
      // Nothing is received before it is sent, but by a clock that is ahead.
      EXPECT_LE(frames[k].reception_time, now + second / 2);
    }
  }
  liar.flush(frames);
  return frames;
}

const std::string stretch = "@+10min/+40min";

/// What becomes of a frame of the stretch.
struct Fate {
  LieKind kind;
  std::string text;         // behind the kind's name and the stretch
  bool by_chance;           // other seeds give other telemetry
  std::size_t least, most;  // how often each frame of the stretch comes
  double changed;           // share of the samples that differ, at the least
};

const std::vector<Fate>& fates() {
  static const std::vector<Fate> all = {
      {LieKind::stuck, ":A", false, 1, 1, 0.6},
      {LieKind::bias_step, ":A*0.5", false, 1, 1, 0.6},
      {LieKind::drifting_bias, ":A*3", false, 1, 1, 0.6},
      {LieKind::noise_burst, ":A", true, 1, 1, 0.6},
      {LieKind::spikes, ":A", true, 1, 1, 0.002},
      {LieKind::swapped, ":A,B", false, 1, 1, 0.9},
      {LieKind::wrong_calibration, ":A", false, 1, 1, 0.6},
      {LieKind::stops, ":A", false, 1, 1, 0},
      {LieKind::wrong_validity, "", true, 1, 1, 0.1},
      {LieKind::frames_lost, "", true, 0, 1, 0},
      {LieKind::passes_lost, "", true, 0, 1, 0},
      {LieKind::backwards_playback, "", false, 1, 1, 0},
      {LieKind::two_stations, "", false, 1, 2, 0},
      {LieKind::two_stamping_stations, "", false, 1, 2, 0},
      {LieKind::time_jump, "", false, 1, 1, 0},
      {LieKind::duplicated_day, "*1800", false, 2, 2, 0},
      {LieKind::repeated_day, "*1800", false, 2, 2, 0},
      {LieKind::simulated_as_real, "", false, 1, 1, 0},
  };
  return all;
}

std::string text_of(const Fate& fate) {
  return std::string(name(fate.kind)) + stretch + fate.text;
}

TEST(Lies, AreAllInTheTable) {
  ASSERT_EQ(fates().size(), lie_kinds);
  for (std::size_t k = 0; k < lie_kinds; ++k) EXPECT_EQ(fates()[k].kind, static_cast<LieKind>(k));
}

TEST(Lies, LeaveFramesOutsideTheirStretchAsTheyAre) {
  const auto truth = true_frames();
  for (const Fate& fate : fates()) {
    std::map<std::uint64_t, std::vector<TelemetryFrame>> by_sequence;
    for (auto& frame : received(truth, {lie_of(text_of(fate))}))
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

TEST(Lies, ChangeAsManySamplesOfTheirStretchAsTheySay) {
  const auto truth = true_frames();
  for (const Fate& fate : fates()) {
    double samples = 0, changed = 0;
    for (const auto& frame : received(truth, {lie_of(text_of(fate))})) {
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

TEST(Lies, AreTheSameForTheSameSeedAlone) {
  // Long enough for passes of which some are lost.
  const auto truth = true_frames(43'200);
  for (const Fate& fate : fates()) {
    const std::string text = std::string(name(fate.kind)) + "@+0s/+12h" + fate.text;
    const auto told = received(truth, {lie_of(text)});
    const auto again = received(truth, {lie_of(text)});
    const auto otherwise = received(truth, {lie_of(text, 2)});
    EXPECT_TRUE(std::equal(told.begin(), told.end(), again.begin(), again.end(), same)) << text;
    EXPECT_EQ(std::equal(told.begin(), told.end(), otherwise.begin(), otherwise.end(), same),
              !fate.by_chance)
        << text;
  }
}

TEST(Lies, AreToldInTheirOrder) {
  const auto truth = true_frames();
  const auto stuck_first =
      received(truth, {lie_of("stuck" + stretch + ":A*2"), lie_of("bias_step" + stretch + ":A*1")});
  const auto bias_first =
      received(truth, {lie_of("bias_step" + stretch + ":A*1"), lie_of("stuck" + stretch + ":A*2")});
  EXPECT_EQ(stuck_first[from_s].samples[0].value, 3);
  EXPECT_EQ(bias_first[from_s].samples[0].value, 2);
  // The stretch of the second one is of the true time all the same.
  const auto jumped =
      received(truth, {lie_of("time_jump" + stretch + "*86400"), lie_of("stops" + stretch + ":A")});
  EXPECT_EQ(jumped.size(), truth.size());
  for (std::size_t k = from_s; k < to_s; ++k)
    for (const Sample& sample : jumped[k].samples) EXPECT_NE(sample.parameter, a_id);
}

// -- of one sensor

/// What A reads at each second of its stretch under a lie.
std::vector<double> readings_of_a(const std::string& text) {
  const auto frames = received(true_frames(), {lie_of(text)});
  std::vector<double> values;
  for (std::size_t k = from_s; k < to_s; ++k) values.push_back(frames.at(k).samples.at(0).value);
  return values;
}

TEST(SensorLies, ReadWhatTheySay) {
  const double span = 40;
  struct Case {
    std::string text;
    std::function<double(double true_value, double passed)> reads;
  };
  const double first = a_at(from_s);
  const auto limited = [](double value) { return std::clamp(value, -10.0, 30.0); };
  for (const auto& [text, reads] : {
           Case{"stuck" + stretch + ":A", [&](double, double) { return first; }},
           Case{"stuck" + stretch + ":A*-3.5", [&](double, double) { return -3.5; }},
           Case{"bias_step" + stretch + ":A",
                [&](double value, double) { return limited(value + 0.02 * span); }},
           Case{"bias_step" + stretch + ":A*-2.5",
                [&](double value, double) { return limited(value - 2.5); }},
           Case{"drifting_bias" + stretch + ":A",
                [&](double value, double passed) { return limited(value + 0.05 * span * passed); }},
           Case{"wrong_calibration" + stretch + ":A",
                [&](double value, double) { return 10 + 1.05 * (value - 10); }},
           Case{"wrong_calibration" + stretch + ":A*0.9",
                [&](double value, double) { return 10 + 0.9 * (value - 10); }},
       }) {
    const auto values = readings_of_a(text);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double passed = static_cast<double>(k) / static_cast<double>(to_s - from_s);
      EXPECT_NEAR(values[k], reads(a_at(from_s + k), passed), 1e-12) << text << " " << k;
    }
  }
}

TEST(SensorLies, AddNoiseOfTheirMagnitude) {
  double sum = 0, squares = 0;
  std::size_t count = 0;
  const auto values = readings_of_a("noise_burst" + stretch + ":A*0.5");
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

TEST(SensorLies, SpikeInOneReadingOfAHundredUpAndDown) {
  std::map<double, int> errors;
  const auto values = readings_of_a("spikes" + stretch + ":A*4");
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = a_at(from_s + k);
    if (std::abs(value - 10) < 15) ++errors[std::round(values[k] - value)];
  }
  EXPECT_EQ(errors.size(), 3U);
  EXPECT_GT(errors[4], 0);
  EXPECT_GT(errors[-4], 0);
  EXPECT_NEAR((errors[4] + errors[-4]) / 1800.0, 0.01, 0.006);
}

TEST(ParameterLies, SwapWhatIsThere) {
  const auto truth = true_frames();
  const auto frames = received(truth, {lie_of("swapped" + stretch + ":A,B")});
  EXPECT_EQ(frames[from_s].samples[0].parameter, b_id);
  EXPECT_EQ(frames[from_s].samples[0].value, truth[from_s].samples[0].value);
  EXPECT_EQ(frames[from_s].samples[1].parameter, a_id);
  // In a frame without B, A comes as B alone.
  EXPECT_EQ(frames[from_s + 1].samples.size(), 1U);
  EXPECT_EQ(frames[from_s + 1].samples[0].parameter, b_id);
}

TEST(ParameterLies, StopAParameterAndNoFrame) {
  const auto frames = received(true_frames(), {lie_of("stops" + stretch + ":A")});
  EXPECT_EQ(frames.size(), truth_s);
  EXPECT_EQ(frames[from_s + 1].samples.size(), 0U);
  EXPECT_EQ(frames[from_s + 2].samples[0].parameter, b_id);
}

TEST(ParameterLies, FlagRightSamplesInvalidAndWrongOnesGood) {
  const auto truth = true_frames();
  auto untrue = truth;
  for (auto& frame : untrue) frame.samples[0].quality = Quality::suspect;
  const auto frames = received(untrue, {lie_of("wrong_validity" + stretch + ":A*0.5")});
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

// -- of frames

TEST(FrameLies, LoseTheShareOfFrames) {
  const auto frames = received(true_frames(), {lie_of("frames_lost" + stretch + "*0.25")});
  EXPECT_NEAR(static_cast<double>(truth_s - frames.size()) / 1800, 0.25, 0.04);
  EXPECT_EQ(received(true_frames(), {lie_of("frames_lost" + stretch + "*1")}).size(),
            truth_s - 1800);
}

TEST(FrameLies, BringWhatIsStoredWithTheNextPassAndLoseWholePasses) {
  const std::size_t day_s = 86'400;
  const auto truth = true_frames(day_s);
  const reference::Orbit orbit({});
  const auto none_lost = received(truth, {lie_of("passes_lost@+0s/+1d*0")});
  EXPECT_EQ(none_lost.size(), day_s);
  for (const TelemetryFrame& frame : none_lost) {
    const bool in_contact = orbit.in_contact(frame.generation_time);
    EXPECT_EQ(in_contact, frame.reception_time == frame.generation_time);
    const bool begins_gap = !in_contact && orbit.in_contact(frame.generation_time - second);
    if (begins_gap && frame.reception_time < start + 86'400 * second) {
      EXPECT_TRUE(orbit.in_contact(frame.reception_time));
      EXPECT_FALSE(orbit.in_contact(frame.reception_time - second));
    }
  }
  EXPECT_TRUE(
      std::is_sorted(none_lost.begin(), none_lost.end(), [](const auto& one, const auto& other) {
        return one.reception_time < other.reception_time;
      }));

  const auto some_lost = received(truth, {lie_of("passes_lost@+0s/+1d*0.5")});
  std::map<Time, int> came;
  for (const TelemetryFrame& frame : some_lost) ++came[frame.generation_time];
  // A pass and the gap before it are lost together, or neither is.
  int passes = 0, lost = 0;
  for (std::size_t k = 1; k < day_s; ++k) {
    const Time now = truth[k].generation_time;
    if (!orbit.in_contact(now) || orbit.in_contact(now - second)) continue;
    ++passes;
    lost += came.count(now) == 0;
    EXPECT_EQ(came.count(now), came.count(now - second));
  }
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, passes);
}

TEST(FrameLies, PlayAStretchBackwardsAfterItsEnd) {
  const auto frames = received(true_frames(), {lie_of("backwards_playback" + stretch + "*60")});
  const Time begins = start + (2400 + 60) * second;
  ASSERT_EQ(frames.size(), truth_s);
  EXPECT_EQ(frames[from_s].sequence, 1000 + to_s);  // nothing of the stretch yet
  std::uint64_t previous = 1000 + to_s;
  std::size_t played = 0;
  for (const TelemetryFrame& frame : frames) {
    if (frame.sequence < 1000 + from_s || frame.sequence >= 1000 + to_s) continue;
    EXPECT_EQ(frame.sequence, --previous);
    const Time before_end = start + 2400 * second - frame.generation_time;
    EXPECT_EQ(frame.reception_time, begins + before_end / 8);
    ++played;
  }
  EXPECT_EQ(played, 1800U);
}

TEST(FrameLies, HearWithTwoStationsWhoseClocksDiffer) {
  for (const auto& [kind, stamps] :
       {std::pair("two_stations", false), {"two_stamping_stations", true}}) {
    const auto frames = received(true_frames(), {lie_of(kind + stretch + "*0.4")});
    std::map<std::uint64_t, std::string> heard;
    for (const TelemetryFrame& frame : frames) {
      const Time true_time = start + static_cast<Time>(frame.sequence - 1000) * second;
      const Time ahead = frame.source == "station-2" ? 400'000'000 : 0;
      EXPECT_EQ(frame.reception_time, true_time + ahead);
      EXPECT_EQ(frame.generation_time, true_time + (stamps ? ahead : 0));
      heard[frame.sequence] += frame.source == "station-2" ? '2' : '1';
    }
    EXPECT_EQ(heard[1000 + from_s + 199], "1");
    EXPECT_EQ(heard[1000 + from_s + 200], "12");
    EXPECT_EQ(heard[1000 + from_s + 399], "12");
    EXPECT_EQ(heard[1000 + from_s + 400], "2");
    EXPECT_EQ(heard[1000 + from_s + 600], "1");
    EXPECT_EQ(heard.size(), truth_s);
  }
}

TEST(FrameLies, JumpInTimeAheadAndBack) {
  for (const double jump_s : {7200.0, -1.5}) {
    const auto frames =
        received(true_frames(), {lie_of("time_jump" + stretch + "*" + std::to_string(jump_s))});
    for (std::size_t k = from_s; k < to_s; ++k) {
      EXPECT_EQ(frames[k].generation_time - frames[k].reception_time,
                static_cast<Time>(jump_s * 1e9));
      EXPECT_EQ(frames[k].sequence, 1000 + k);
    }
  }
}

TEST(FrameLies, SendADayAgainAsAnotherOrAsItWas) {
  const auto truth = true_frames();
  for (const auto& [kind, stamped] : {std::pair("duplicated_day", true), {"repeated_day", false}}) {
    std::map<std::uint64_t, Time> arrived;
    for (const TelemetryFrame& frame : received(truth, {lie_of(kind + stretch + "*1800")})) {
      const TelemetryFrame& first = truth[frame.sequence - 1000];
      if (arrived.emplace(frame.sequence, frame.reception_time).second) {
        EXPECT_TRUE(same(frame, first));
        continue;
      }
      EXPECT_EQ(frame.reception_time, first.reception_time + 1800 * second);
      auto unstamped = frame;
      if (stamped) unstamped.generation_time -= 1800 * second;
      unstamped.reception_time -= 1800 * second;
      EXPECT_TRUE(same(unstamped, first));
      // The copy comes before what is really of that time.
      EXPECT_EQ(arrived.count(frame.sequence + 1800), 0U);
    }
  }
}

TEST(FrameLies, SendTheSimulatorAsRealBeforeTheSpacecraft) {
  const auto frames = received(true_frames(), {lie_of("simulated_as_real" + stretch)});
  EXPECT_EQ(frames.size(), truth_s + 1800);
  HandwrittenEps simulator({}, {}, start + 600 * second, 1);
  std::uint64_t sequence = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (frames[k].source != "simulator") continue;
    EXPECT_EQ(frames[k].origin, storage::Origin::real);
    EXPECT_EQ(frames[k].sequence, ++sequence);
    EXPECT_EQ(frames[k].generation_time, simulator.time());
    ASSERT_EQ(frames[k + 1].source, "station");
    EXPECT_EQ(frames[k + 1].generation_time, simulator.time());
    std::vector<Sample> samples;
    simulator.read(samples);
    ASSERT_EQ(frames[k].samples.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      EXPECT_EQ(frames[k].samples[i].value, samples[i].value);
    simulator.advance();
  }
}

// -- as text

TEST(LieText, SaysAllOfALie) {
  const Lie lie = lie_of("swapped@2017-07-01T00:10:00Z/+1h:V_BAT1,V_BAT2");
  EXPECT_EQ(lie.kind, LieKind::swapped);
  EXPECT_EQ(lie.when, (storage::TimeRange{start + 600 * second, start + 3600 * second}));
  EXPECT_EQ(lie.parameter, "V_BAT1");
  EXPECT_EQ(lie.other, "V_BAT2");
  EXPECT_FALSE(lie.magnitude);
  const Lie jump = lie_of("time_jump@2017-07-01T00:10/2017-07-01T00:20:30*-1.5");
  EXPECT_EQ(jump.when, (storage::TimeRange{start + 600 * second, start + 1230 * second}));
  EXPECT_EQ(jump.parameter, "");
  EXPECT_EQ(jump.magnitude, -1.5);
  for (std::size_t k = 0; k < lie_kinds; ++k) {
    const auto kind = static_cast<LieKind>(k);
    EXPECT_EQ(lie_of(std::string(name(kind)) + "@+1s/+2s").kind, kind);
  }
}

TEST(LieText, RefusesWhatCannotBeTold) {
  struct Case {
    std::string text;
    std::string complaint;
  };
  for (const auto& [text, complaint] : {
           Case{"", "is not KIND@FROM/TO[:PARAMETER[,OTHER]][*MAGNITUDE]"},
           Case{"stuck@+1h:A", "is not KIND@FROM/TO"},
           Case{"stuk@+1h/+2h:A", "there is no lie 'stuk'; the lies are: stuck, bias_step,"},
           Case{"stuck@noon/+2h:A", "'noon' is neither a time such as"},
           Case{"stuck@+1h/-2h:A", "'-2h' is neither a time such as"},
           Case{"stuck@+1h/+2h:A*much", "'much' is not a number"},
           Case{"stuck@+2h/+2h:A",
                "the lie stuck ends at 2017-07-01T02:00:00Z, which is not after"},
           Case{"stuck@+1h/+2h", "the lie stuck needs a parameter, such as :V_BUS"},
           Case{"stuck@+1h/+2h:X",
                "the lie stuck names no parameter: 'X'; the parameters are: A, B, S"},
           Case{"spikes@+1h/+2h:S", "the lie spikes needs an analog parameter; 'S' is digital"},
           Case{"stops@+1h/+2h:A,B", "the lie stops is about one parameter; leave out 'B'"},
           Case{"stops@+1h/+2h:A*3", "the lie stops has no magnitude; leave out '*3'"},
           Case{"swapped@+1h/+2h:A", "the lie swapped needs two parameters"},
           Case{"swapped@+1h/+2h:A,A", "the lie swapped swaps 'A' with itself"},
           Case{"frames_lost@+1h/+2h:A", "is about whole frames; leave out 'A'"},
           Case{"frames_lost@+1h/+2h*1.5", "takes a share from 0 to 1 as its magnitude; 1.5 is"},
           Case{"repeated_day@+1h/+2h*-1", "takes seconds from 0 to 1e+09 as its magnitude; -1 is"},
           Case{"time_jump@+1h/+2h*1e10", "takes seconds from -1e+09 to 1e+09 as its magnitude"},
       }) {
    auto parsed = parse_lie(text, start);
    std::optional<LieError> error;
    if (auto* wrong = std::get_if<LieError>(&parsed))
      error = *wrong;
    else
      error = obstacle(std::get<Lie>(parsed), parameters());
    ASSERT_TRUE(error) << text;
    EXPECT_THAT(error->message, HasSubstr(complaint));
  }
  const std::vector<Lie> impossible = {lie_of("stuck@+1h/+2h:X")};
  EXPECT_THROW(Liar(impossible, parameters()), std::invalid_argument);
}

}  // namespace
}  // namespace reident::satcs
