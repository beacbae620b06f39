#include "tests/service/satcs/faults/faults_fixture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace reident::satcs::test {

using storage::Quality;
using storage::Sample;
using storage::TelemetryFrame;

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
std::vector<TelemetryFrame> true_frames(std::size_t seconds) {
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

Fault fault_of(const std::string& text, std::uint64_t seed) {
  auto parsed = parse_fault(text, start);
  if (const auto* error = std::get_if<FaultError>(&parsed))
    throw std::runtime_error(error->message);
  auto fault = std::get<Fault>(parsed);
  fault.seed = seed;
  return fault;
}

std::vector<TelemetryFrame> received(std::vector<TelemetryFrame> truth,
                                     const std::vector<Fault>& faults) {
  const auto described = parameters();
  FaultInjector injector(faults, described);
  std::vector<TelemetryFrame> frames;
  for (auto& frame : truth) {
    const Time now = frame.generation_time;
    const std::size_t before = frames.size();
    injector.take(std::move(frame), frames);
    for (std::size_t k = before; k < frames.size(); ++k) {
      // Nothing is received before it is sent, but by a clock that is ahead.
      EXPECT_LE(frames[k].reception_time, now + second / 2);
    }
  }
  injector.flush(frames);
  return frames;
}

}  // namespace reident::satcs::test
