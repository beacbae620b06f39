// The configuration of the service under test.
#pragma once

#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/satcs/family.hpp"

namespace reident::trust {

/// Telemetry of the power subsystem comes, and is put on the grid, each so often: months at 1 Hz
/// are not affordable.
inline constexpr Duration suite_period = 8'000'000'000;
/// The period of the platform, which is slower.
inline constexpr Duration platform_period = 16'000'000'000;

/// The text of deploy/reference.toml, for the platform reference-platform.toml, with, for each
/// equipment, the keys
///
///   sample_period = "8s" or "16s", window = "48000s" (eight orbits), slide = "18000s" (three),
///   validation_share = 0.4, order = [1, 6]
///
/// and `keys`, in TOML, of the equipment that alone which is named here; all of it where none is.
/// The database is reference.db. Throws std::runtime_error where the file cannot be read, or `keys`
/// are no TOML.
std::string suite_toml(const std::vector<std::string>& equipment = {},
                       satcs::Family family = satcs::Family::power, const std::string& keys = "");

/// What reidentd would make of that text, but with a database that is thrown away, and so few
/// recent samples that months of them are in chunks, as at 1 Hz. Throws std::runtime_error with the
/// first mistake.
Config suite_config(satcs::Family family = satcs::Family::power, const std::string& keys = "");

}  // namespace reident::trust
