// What commands say of equipment whose telemetry has left its ticks.
#pragma once

#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "storage/database/database.hpp"

namespace reident::cli {

/// Returns advised_phase() (service/windows/ticks.hpp) of what the database has of each configured
/// equipment, or of those of one spacecraft or one name. Throws storage::Error.
std::vector<std::string> advised_phases(storage::Database& database, const Config& config,
                                        const std::string& spacecraft = {},
                                        const std::string& equipment = {});

}  // namespace reident::cli
