// What a line between rows says that is not so above the header: files were joined there. Private
// to this folder.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "service/telemetry_file/row_reader.hpp"

namespace reident::telemetry_file {

/// The spacecraft that a line is about, as "# Spacecraft: SAT-1"; empty: none.
std::string spacecraft_of_line(std::string_view line);

/// What a line says of the rows below it that the lines above the header do not say of all rows:
/// another zone or time scale where times are `of_lines`, another spacecraft. Absent: nothing.
std::optional<std::string> said_otherwise(std::string_view line,
                                          std::span<const NumberedLine> above, bool of_lines);

}  // namespace reident::telemetry_file
