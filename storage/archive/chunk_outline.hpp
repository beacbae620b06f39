// What is known of a chunk before it is decoded, for those who keep what they made of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "storage/chunks/sample_gaps.hpp"

namespace reident::storage {

struct ChunkOutline {
  Time first = 0, last = 0;  // of its samples
  std::size_t samples = 0;
  Sampling sampling;
  /// Checksum of all that it holds, times included: a chunk that was written again is another one.
  std::uint64_t identity = 0;
  /// Whether the series has nothing between the outline before and this one.
  bool follows = false;
  std::int64_t series = 0, shard = 0, data = 0;  // where its bytes are
};

}  // namespace reident::storage
