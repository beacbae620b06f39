// A stream of telemetry as a CSV file that satcs-replay and `reident identify` take.
#pragma once

#include <stop_token>

#include "service/satcs/frame_stream.hpp"
#include "service/support/output_file.hpp"

namespace reident::satcs {

/// A row for each frame, in their order. The first column is the generation time in seconds since
/// 1970 UTC (unix_s), then one for each parameter, with as many digits as its value needs; a blank
/// cell is an invalid sample, or none. Senders, qualities and reception times are left out. Shows
/// progress on a terminal. False where a stop was requested before the end; the file is then not
/// finished. Throws std::runtime_error when the file cannot be written.
bool write_csv(FrameStream& stream, OutputFile& file, const std::stop_token& stop);

}  // namespace reident::satcs
