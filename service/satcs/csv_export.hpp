// A stream of telemetry as a CSV file that satcs-replay and `reident identify` take.
#pragma once

#include <filesystem>

#include "service/satcs/frame_stream.hpp"

namespace reident::satcs {

/// A row for each frame, in their order. The first column is the generation time in seconds since
/// 1970 UTC (unix_s), then one for each parameter, with as many digits as its value needs; a blank
/// cell is an invalid sample, or none. Senders, qualities and reception times are left out. Throws
/// std::runtime_error when the file cannot be written.
void write_csv(FrameStream& stream, const std::filesystem::path& path);

}  // namespace reident::satcs
