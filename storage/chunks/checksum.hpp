// XXH64: 64 bits that show whether bytes are damaged. Private to storage.
//
// Reference: Y. Collet, xxHash fast digest algorithm, specification 0.1.1, section "XXH64". It
// guards against chance, not against a forger.
#pragma once

#include <cstdint>
#include <span>

namespace reident::storage {

/// XXH64 with seed 0.
std::uint64_t xxh64(std::span<const std::uint8_t> bytes);

}  // namespace reident::storage
