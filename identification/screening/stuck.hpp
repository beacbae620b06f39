// Sensors that repeat one value. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// Returns the plateaus of one of the channels, which is analog, in which its sensor is stuck; by
/// time. The first channels are so many inputs, which may be at rest by command.
std::vector<Plateau> stuck_plateaus(const std::vector<Channel>& channels, std::size_t self,
                                    std::size_t inputs);

}  // namespace reident::identification
