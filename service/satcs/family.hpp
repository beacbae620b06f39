// The families of equipment that satcs-reference simulates, and what their telemetry is called.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

namespace reference {
struct PointInfo;
}

enum class Family {
  power,     // the electrical power subsystem (reference/REFERENCE.md)
  platform,  // thermal nodes, reaction wheels and a transmitter (platform/PLATFORM.md)
};

/// "power" or "platform".
std::string_view name(Family family);
std::optional<Family> parse_family(std::string_view text);

/// The family's telemetry points, and those that its hand-written simulation has. No parameter is
/// of both families.
std::vector<storage::ParameterDescriptor> family_descriptors(Family family,
                                                             std::string_view spacecraft);
std::vector<storage::ParameterDescriptor> simulated_descriptors(Family family,
                                                                std::string_view spacecraft);

/// The telemetry point of a name, of either family; null where there is none.
const reference::PointInfo* find_point(std::string_view parameter);

}  // namespace reident::satcs
