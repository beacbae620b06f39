// Telemetry as SATCS distributes it and as the archive keeps it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/types/quality.hpp"

namespace reident::storage {

/// Nanoseconds since 1970-01-01T00:00:00 UTC.
using Time = std::int64_t;
inline constexpr Time second_ns = 1'000'000'000;

/// Half-open range of time [begin, end). An end at the greatest Time includes it, so that every
/// time lies in some range.
struct TimeRange {
  Time begin = 0;
  Time end = 0;
  bool operator==(const TimeRange&) const = default;
};

/// Telemetry of the satellite, or of the simulator under improvement. The same parameter of both
/// is two series.
enum class Origin : std::uint8_t { real = 0, simulated = 1 };
std::string_view name(Origin origin);

struct Sample {
  std::uint32_t parameter = 0;  // id within the spacecraft
  Quality quality = Quality::good;
  double value = 0;
};

struct TelemetryFrame {
  std::string spacecraft;
  std::string source;  // ground station, gateway or simulator that sent it
  Origin origin = Origin::real;
  std::uint64_t sequence = 0;  // counts the frames of one source
  Time generation_time = 0;    // on board
  Time reception_time = 0;     // on the ground
  std::vector<Sample> samples;
  bool numbered = true;  // false: it has no sequence number, as one that comes from a file
  std::uint64_t first_sequence = 0;  // of the source's run; 0: the source does not say
};

enum class ParameterKind : std::uint8_t { analog = 0, digital = 1 };
std::string_view name(ParameterKind kind);

struct ParameterDescriptor {
  std::string spacecraft;
  std::uint32_t id = 0;
  std::string name;
  std::string unit;
  std::string description;
  ParameterKind kind = ParameterKind::analog;
  std::optional<double> low_limit, high_limit;
  bool operator==(const ParameterDescriptor&) const = default;
};

}  // namespace reident::storage
