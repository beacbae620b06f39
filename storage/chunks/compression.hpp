// Blocks of bytes through zstd, or as they are where zstd does not make them smaller. Private to
// storage.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "storage/chunks/bytes.hpp"

namespace reident::storage {

/// Keeps zstd's tables between blocks. Throws std::bad_alloc when there is no memory for them.
class Compressor {
 public:
  /// zstd's levels, 1 (fast) to 22 (small).
  explicit Compressor(int level);
  ~Compressor();

  /// Puts a block into `out`: varint (2 * stored bytes + 1 if they are a zstd frame), the bytes.
  void put(Bytes raw, std::vector<std::uint8_t>& out);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::vector<std::uint8_t> frame_;
};

class Decompressor {
 public:
  Decompressor();
  ~Decompressor();

  /// Fills `raw` from the block that `in` stands at. False unless the block gives just so many
  /// bytes.
  bool get(ByteReader& in, std::span<std::uint8_t> raw);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace reident::storage
