#include "service/satcs/family.hpp"

#include <algorithm>

#include "service/satcs/platform/handwritten_platform.hpp"
#include "service/satcs/platform/platform_telemetry.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"

namespace reident::satcs {
namespace {

const reference::PointInfo* find_among(const auto& points, std::string_view name) {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [name](const auto& point) { return point.name == name; });
  return found == points.end() ? nullptr : &*found;
}

}  // namespace

std::string_view name(Family family) {
  return family == Family::power ? "power" : "platform";
}

std::optional<Family> parse_family(std::string_view text) {
  for (const Family family : {Family::power, Family::platform})
    if (name(family) == text) return family;
  return std::nullopt;
}

std::vector<storage::ParameterDescriptor> family_descriptors(Family family,
                                                             std::string_view spacecraft) {
  return family == Family::power ? reference::telemetry_descriptors(spacecraft)
                                 : platform::telemetry_descriptors(spacecraft);
}

std::vector<storage::ParameterDescriptor> simulated_descriptors(Family family,
                                                                std::string_view spacecraft) {
  return family == Family::power ? handwritten_descriptors(spacecraft)
                                 : platform::handwritten_descriptors(spacecraft);
}

const reference::PointInfo* find_point(std::string_view parameter) {
  if (const auto* point = find_among(reference::telemetry_points(), parameter)) return point;
  return find_among(platform::telemetry_points(), parameter);
}

}  // namespace reident::satcs
