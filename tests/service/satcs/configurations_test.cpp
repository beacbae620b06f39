// The configurations in deploy/ and the telemetry that they are for.
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/config/config.hpp"
#include "service/satcs/platform/platform_telemetry.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"
#include "service/windows/window_data.hpp"

namespace reident::satcs::configurations_test {
namespace {

/// What a row of the equipment's has values of. A relation is looked at where it has its own.
std::vector<std::string> channels_of(EquipmentConfig equipment) {
  equipment.relations.clear();
  return parameters_of(equipment);
}

/// What each equipment of the file holds for less long than its points are apart.
template <typename Points>
std::vector<std::string> held_too_short(const char* file, const Points& points) {
  std::map<std::string_view, int> every_s;
  for (const auto& point : points) every_s[point.name] = point.every_s;
  const auto config = load_config(std::filesystem::path(REIDENT_EXAMPLES) / file);
  std::vector<std::string> found;
  for (const EquipmentConfig& equipment : std::get<Config>(config).spacecraft.at(0).equipment)
    for (const std::string& parameter : channels_of(equipment))
      if (equipment.sample_hold < every_s.at(parameter) * Duration{1'000'000'000})
        found.push_back(equipment.name + " " + parameter);
  return found;
}

TEST(Configurations, HoldEachSampleUntilTheNextOne) {
  EXPECT_THAT(held_too_short("reference.toml", reference::telemetry_points()), testing::IsEmpty());
  EXPECT_THAT(held_too_short("reference-platform.toml", platform::telemetry_points()),
              testing::IsEmpty());
}

}  // namespace
}  // namespace reident::satcs::configurations_test
