// The telemetry points of the platform family.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "service/satcs/platform/platform_plant.hpp"
#include "service/satcs/reference/telemetry_point.hpp"

namespace reident::satcs::platform {

using TelemetryPoint = reference::PointOf<PlatformPlant>;

/// Every point, in the order in which a reading holds those that are due. Their ids follow from
/// their names (parameter_id).
std::span<const TelemetryPoint> telemetry_points();
/// Their descriptors; the limits are the ends of the sensors' ranges.
std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft);

}  // namespace reident::satcs::platform
