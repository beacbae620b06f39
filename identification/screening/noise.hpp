// Bursts of noise in one channel. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// Rows [begin, end) of one segment.
struct NoisyRows {
  Index begin = 0, end = 0;
  std::size_t segment = 0;
};

/// Returns the bursts of each channel, by time; those of channels that are not analog are empty.
std::vector<std::vector<NoisyRows>> noise_bursts(const std::vector<Channel>& channels,
                                                 const Record& record);

}  // namespace reident::identification
