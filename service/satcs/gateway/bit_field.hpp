// Numbers from fields of bits, wherever they begin.
#pragma once

#include <cstdint>
#include <span>

#include "service/satcs/gateway/xtce.hpp"

namespace reident::satcs {

/// Bits [first, first + count) of `bytes`, the most significant bit of the first byte being bit 0;
/// at most 64, and not beyond the end. The last one is the least significant.
std::uint64_t bits_of(std::span<const std::uint8_t> bytes, std::uint64_t first,
                      std::uint32_t count);

/// A number as it stands in a packet. Integers have all 64 bits, of which a double keeps 53.
struct RawNumber {
  double value = 0;
  std::int64_t integer = 0;  // of integers; above its range the largest
};
/// The field of `encoding.size.bits` bits that begins at `first`, by its coding and order of bytes
/// and bits. The coding is one of numbers, with a size that it allows (xtce.hpp).
RawNumber number_of(std::span<const std::uint8_t> bytes, std::uint64_t first,
                    const xtce::Encoding& encoding);

}  // namespace reident::satcs
