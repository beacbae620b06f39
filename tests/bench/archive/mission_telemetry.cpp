#include "tests/bench/archive/mission_telemetry.hpp"

#include <unordered_map>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::bench {
namespace {

namespace reference = satcs::reference;

constexpr storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
constexpr storage::Time second = 1'000'000'000;
constexpr std::uint64_t day_seconds = 86'400;
constexpr std::uint64_t shift_seconds = 3'571;

}  // namespace

MissionTelemetry::MissionTelemetry(std::size_t parameters)
    : parameters_(parameters), points_(reference::telemetry_points().size()) {
  constexpr std::uint64_t seed = 1;
  reference::Spacecraft spacecraft(reference::Constants{}, {}, start, seed);
  day_.reserve(day_seconds * points_);
  std::unordered_map<std::uint32_t, std::size_t> point_of;
  for (const auto& point : reference::telemetry_points())
    point_of.emplace(satcs::parameter_id(point.name), point_of.size());
  // A point that is not due holds its value: the archive is measured with every parameter at 1 Hz.
  std::vector<double> last = spacecraft.noise_free();
  std::vector<storage::Sample> samples;
  for (std::uint64_t k = 0; k < day_seconds; ++k, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const storage::Sample& sample : samples)
      last[point_of.at(sample.parameter)] = sample.value;
    day_.insert(day_.end(), last.begin(), last.end());
  }
}

storage::Time MissionTelemetry::time(std::uint64_t k) {
  return start + static_cast<storage::Time>(k) * second;
}

std::uint64_t MissionTelemetry::frame_at(storage::Time time) {
  return static_cast<std::uint64_t>((time - start) / second);
}

double MissionTelemetry::value(std::size_t parameter, std::uint64_t k) const {
  const std::uint64_t at = (k + parameter / points_ * shift_seconds) % day_seconds;
  return day_[at * points_ + parameter % points_];
}

void MissionTelemetry::fill(std::uint64_t k, const std::string& spacecraft,
                            storage::TelemetryFrame& frame) const {
  frame.spacecraft = spacecraft;
  frame.source = "bench";
  frame.sequence = k + 1;
  frame.generation_time = time(k);
  frame.reception_time = frame.generation_time;
  frame.samples.resize(parameters_);
  for (std::size_t i = 0; i < parameters_; ++i)
    frame.samples[i] = {static_cast<std::uint32_t>(i + 1), storage::Quality::good, value(i, k)};
}

std::vector<storage::ParameterDescriptor> MissionTelemetry::descriptors(
    const std::string& spacecraft) const {
  const auto points = reference::telemetry_points();
  std::vector<storage::ParameterDescriptor> result;
  for (std::size_t i = 0; i < parameters_; ++i)
    result.push_back({.spacecraft = spacecraft,
                      .id = static_cast<std::uint32_t>(i + 1),
                      .name = "P" + std::to_string(i + 1),
                      .unit = std::string(points[i % points_].unit),
                      .description = std::string(points[i % points_].name),
                      .kind = points[i % points_].kind,
                      .low_limit = {},
                      .high_limit = {}});
  return result;
}

}  // namespace reident::bench
