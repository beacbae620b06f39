// What a database yields, in lines for people.
#pragma once

#include <string>
#include <vector>

#include "service/satcs/gateway/packet_stream.hpp"
#include "service/satcs/gateway/xtce.hpp"

namespace reident::satcs {

/// "FILE: line 12: PATH: what": what the gateway does not know, in the order of the file.
std::vector<std::string> note_lines(const xtce::Database& database, const std::string& file);

/// "SAT: 3 containers, 12 parameters, of which 9 are published; packets begin with CCSDSPacket".
std::string summary_line(const xtce::Database& database,
                         const std::vector<GatewayParameter>& parameters);

/// A line a parameter that packets bring, below one with the names of the columns; then a line each
/// for those that are not published, with the reason.
std::vector<std::string> parameter_lines(const xtce::Database& database,
                                         const std::vector<GatewayParameter>& parameters);

}  // namespace reident::satcs
