#include "storage/chunks/compression.hpp"

#include <algorithm>
#include <new>
#include <zstd.h>

namespace reident::storage {

struct Compressor::Context {
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
  ~Context() { ZSTD_freeCCtx(zstd); }
};

struct Decompressor::Context {
  ZSTD_DCtx* zstd = ZSTD_createDCtx();
  ~Context() { ZSTD_freeDCtx(zstd); }
};

Compressor::Compressor(int level) : context_(std::make_unique<Context>()) {
  if (context_->zstd == nullptr) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_contentSizeFlag, 0);  // the reader knows it
}

Compressor::~Compressor() = default;

void Compressor::put(Bytes raw, std::vector<std::uint8_t>& out) {
  frame_.resize(ZSTD_compressBound(raw.size()));
  const std::size_t size =
      ZSTD_compress2(context_->zstd, frame_.data(), frame_.size(), raw.data(), raw.size());
  const bool smaller = ZSTD_isError(size) == 0 && size < raw.size();
  const Bytes stored = smaller ? Bytes(frame_).first(size) : raw;
  ByteWriter writer(out);
  writer.varint(2 * stored.size() + (smaller ? 1 : 0));
  writer.bytes(stored);
}

Decompressor::Decompressor() : context_(std::make_unique<Context>()) {
  if (context_->zstd == nullptr) throw std::bad_alloc();
}

Decompressor::~Decompressor() = default;

bool Decompressor::get(ByteReader& in, std::span<std::uint8_t> raw) {
  const std::uint64_t head = in.varint();
  const Bytes stored = in.bytes(head / 2);
  if (in.failed()) return false;
  if (head % 2 == 0) {
    if (stored.size() != raw.size()) return false;
    std::copy(stored.begin(), stored.end(), raw.begin());
    return true;
  }
  return ZSTD_decompressDCtx(context_->zstd, raw.data(), raw.size(), stored.data(),
                             stored.size()) == raw.size();
}

}  // namespace reident::storage
