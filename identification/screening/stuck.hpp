// Sensors that repeat one value. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// Returns the plateaus of one of the channels, which is analog, in which its sensor is stuck; by
/// time.
std::vector<Plateau> stuck_plateaus(const std::vector<Channel>& channels, std::size_t self);

}  // namespace reident::identification
