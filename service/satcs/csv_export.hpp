// A source of telemetry as a CSV file that satcs-replay and `reident identify` take.
#pragma once

#include <filesystem>

#include "service/satcs/publisher.hpp"

namespace reident::satcs {

/// The first column is the time in seconds since 1970 UTC (unix_s), then one for each parameter,
/// with as many digits as its value needs; an invalid sample is a blank cell. Throws
/// std::runtime_error when the file cannot be written.
void write_csv(FrameSource& source, const std::filesystem::path& path);

}  // namespace reident::satcs
