// A fragment: what one append brought of one series, in bytes that cost next to nothing to write
// and to read. Chunks are smaller; a fragment waits in the file until enough of them make a chunk.
// SCHEMA.md has the format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "storage/chunks/chunk.hpp"

namespace reident::storage {

/// Appends the fragment of 1 to most_samples samples, ascending in time and no two at one time, to
/// `out`.
void encode_fragment(const ChunkSamples& samples, std::vector<std::uint8_t>& out);

/// Appends the samples with a time in `range` to the target. After an error it is as it was. Bytes
/// from anywhere may be read.
std::optional<ChunkError> decode_fragment(std::span<const std::uint8_t> bytes, TimeRange range,
                                          const ChunkTarget& target);

}  // namespace reident::storage
