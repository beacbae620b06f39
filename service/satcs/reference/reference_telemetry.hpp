// The telemetry points of the reference spacecraft: what each reads, its sensor and its rate.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "service/satcs/reference/reference_plant.hpp"
#include "service/satcs/reference/reference_sensor.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// One row of the table. Digital points are 0 or 1 and have no sensor.
struct TelemetryPoint {
  std::string_view name;
  std::string_view unit;
  std::string_view description;
  storage::ParameterKind kind = storage::ParameterKind::analog;
  int every_s = 1;  // sampled when the seconds since 1970, modulo this, are phase_s
  int phase_s = 0;
  double (*read)(const Plant& plant) = nullptr;
  SensorSpec sensor;

  /// Whether it is sampled at a second since 1970, also one before.
  bool due(std::int64_t second) const {
    return every_s == 1 || (second % every_s + every_s) % every_s == phase_s;
  }
};

/// Every point, in the order in which a reading holds those that are due. Their ids follow from
/// their names (parameter_id).
std::span<const TelemetryPoint> telemetry_points();
/// Returns their descriptors; the limits are the ends of the sensors' ranges.
std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft);

}  // namespace reident::satcs::reference
