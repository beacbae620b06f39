// Reads an XTCE database (https://www.omg.org/spec/XTCE/1.2) from its XML file.
#pragma once

#include <filesystem>
#include <variant>

#include "service/satcs/gateway/xtce.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs::xtce {

/// What the file says about telemetry; commands are not read. Whatever else it has that the gateway
/// does not know is in the notes. An error where it is no XML, no XTCE, or has no container.
std::variant<Database, csv::Error> read_database(const std::filesystem::path& file);

}  // namespace reident::satcs::xtce
