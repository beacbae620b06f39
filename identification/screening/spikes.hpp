// Samples that stand out from their neighbours and that no other channel explains. Private to this
// folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// Returns the plateaus of one of the channels, which is analog, that are spikes; by time.
std::vector<Plateau> spikes_of(const std::vector<Channel>& channels, std::size_t self);

}  // namespace reident::identification
