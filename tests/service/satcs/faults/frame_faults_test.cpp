#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "service/satcs/faults/fault_injector.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_orbit.hpp"
#include "tests/service/satcs/faults/faults_fixture.hpp"

namespace reident::satcs::frame_faults_test {
namespace {

using namespace test;
using storage::Sample;
using storage::TelemetryFrame;

TEST(FrameFaults, LoseTheShareOfFrames) {
  const auto frames = received(true_frames(), {fault_of("frames_lost" + fault_range + "*0.25")});
  EXPECT_NEAR(static_cast<double>(truth_s - frames.size()) / 1800, 0.25, 0.04);
  EXPECT_EQ(received(true_frames(), {fault_of("frames_lost" + fault_range + "*1")}).size(),
            truth_s - 1800);
}

TEST(FrameFaults, BringWhatIsStoredWithTheNextPassAndLoseWholePasses) {
  const std::size_t day_s = 86'400;
  const auto truth = true_frames(day_s);
  const reference::Orbit orbit({});
  const auto none_lost = received(truth, {fault_of("passes_lost@+0s/+1d*0")});
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

  const auto some_lost = received(truth, {fault_of("passes_lost@+0s/+1d*0.5")});
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

TEST(FrameFaults, PlayARangeBackwardsAfterItsEnd) {
  const auto frames =
      received(true_frames(), {fault_of("backwards_playback" + fault_range + "*60")});
  const Time begins = start + (2400 + 60) * second;
  ASSERT_EQ(frames.size(), truth_s);
  EXPECT_EQ(frames[from_s].sequence, 1000 + to_s);  // nothing of the range yet
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

TEST(FrameFaults, HearWithTwoStationsWhoseClocksDiffer) {
  for (const auto& [kind, stamps] :
       {std::pair("two_stations", false), {"two_stamping_stations", true}}) {
    const auto frames = received(true_frames(), {fault_of(kind + fault_range + "*0.4")});
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

TEST(FrameFaults, JumpInTimeAheadAndBack) {
  for (const double jump_s : {7200.0, -1.5}) {
    const auto frames = received(
        true_frames(), {fault_of("time_jump" + fault_range + "*" + std::to_string(jump_s))});
    for (std::size_t k = from_s; k < to_s; ++k) {
      EXPECT_EQ(frames[k].generation_time - frames[k].reception_time,
                static_cast<Time>(jump_s * 1e9));
      EXPECT_EQ(frames[k].sequence, 1000 + k);
    }
  }
}

TEST(FrameFaults, SendADayAgainAsAnotherOrAsItWas) {
  const auto truth = true_frames();
  for (const auto& [kind, stamped] : {std::pair("duplicated_day", true), {"repeated_day", false}}) {
    std::map<std::uint64_t, Time> arrived;
    for (const TelemetryFrame& frame : received(truth, {fault_of(kind + fault_range + "*1800")})) {
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

TEST(FrameFaults, SendTheSimulatorAsRealBeforeTheSpacecraft) {
  const auto frames = received(true_frames(), {fault_of("simulated_as_real" + fault_range)});
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

}  // namespace
}  // namespace reident::satcs::frame_faults_test
