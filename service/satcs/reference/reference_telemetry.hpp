// The telemetry points of the reference spacecraft: what each reads, its sensor and its rate.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "service/satcs/reference/reference_plant.hpp"
#include "service/satcs/reference/telemetry_point.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// One row of the table.
using TelemetryPoint = PointOf<Plant>;

/// Every point, in the order in which a reading holds those that are due. Their ids follow from
/// their names (parameter_id).
std::span<const TelemetryPoint> telemetry_points();
/// Returns their descriptors; the limits are the ends of the sensors' ranges.
std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft);

}  // namespace reident::satcs::reference
