// A telemetry point: what it is called, when it is sampled, its sensor, and what it reads of a
// plant.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_sensor.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// What a point is, whatever the plant. Digital points are 0 or 1 and have no sensor.
struct PointInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view description;
  storage::ParameterKind kind = storage::ParameterKind::analog;
  int every_s = 1;  // sampled when the seconds since 1970, modulo this, are phase_s
  int phase_s = 0;
  SensorSpec sensor;

  /// Whether it is sampled at a second since 1970, also one before.
  bool due(std::int64_t second) const {
    return every_s == 1 || (second % every_s + every_s) % every_s == phase_s;
  }
  bool digital() const { return kind == storage::ParameterKind::digital; }
};

/// `read` takes what the sensor measures, or the digital value, from the plant.
template <class Plant>
struct PointOf : PointInfo {
  double (*read)(const Plant& plant) = nullptr;
};

/// When a point is sampled.
struct Rate {
  int every_s;
  int phase_s;
};
inline constexpr Rate every_second{1, 0};

template <class Plant>
constexpr PointOf<Plant> analog_point(std::string_view name, std::string_view unit,
                                      std::string_view description, Rate rate,
                                      const SensorSpec& sensor, double (*read)(const Plant&)) {
  return {
      {name, unit, description, storage::ParameterKind::analog, rate.every_s, rate.phase_s, sensor},
      read};
}

template <class Plant>
constexpr PointOf<Plant> digital_point(std::string_view name, std::string_view description,
                                       Rate rate, double (*read)(const Plant&)) {
  return {{name, {}, description, storage::ParameterKind::digital, rate.every_s, rate.phase_s, {}},
          read};
}

/// Returns the descriptors of points; the limits are the ends of the sensors' ranges.
template <class Point>
std::vector<storage::ParameterDescriptor> descriptors_of(std::span<const Point> points,
                                                         std::string_view spacecraft) {
  std::vector<storage::ParameterDescriptor> descriptors;
  for (const PointInfo& point : points) {
    storage::ParameterDescriptor d;
    d.spacecraft = spacecraft;
    d.id = parameter_id(point.name);
    d.name = point.name;
    d.unit = point.unit;
    d.description = point.description;
    d.kind = point.kind;
    if (!point.digital()) {
      d.low_limit = point.sensor.low;
      d.high_limit = point.sensor.high;
    }
    descriptors.push_back(std::move(d));
  }
  return descriptors;
}

}  // namespace reident::satcs::reference
