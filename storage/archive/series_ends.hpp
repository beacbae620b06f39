// First and last time of what a series holds. Private to storage.
#pragma once

#include "storage/archive/chunk_store.hpp"
#include "storage/archive/recent_tier.hpp"

namespace reident::storage {

/// Finds them again where samples were removed.
void find_ends(SeriesHead& series, ChunkStore& chunks);

}  // namespace reident::storage
