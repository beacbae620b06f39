// Little-endian bytes of the chunk format, written and read with checks. Private to storage.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace reident::storage {

using Bytes = std::span<const std::uint8_t>;

/// Signed numbers near zero as small unsigned ones: 0, -1, 1, -2, ...
constexpr std::uint64_t zigzag(std::int64_t number) {
  return (static_cast<std::uint64_t>(number) << 1) ^ static_cast<std::uint64_t>(number >> 63);
}
constexpr std::int64_t from_zigzag(std::uint64_t code) {
  return static_cast<std::int64_t>((code >> 1) ^ (0 - (code & 1)));
}

class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  void byte(std::uint8_t number) { out_.push_back(number); }
  /// The lowest `width` bytes of a number.
  void fixed(std::uint64_t number, int width) {
    for (int i = 0; i < width; ++i) byte(static_cast<std::uint8_t>(number >> (8 * i)));
  }
  void real(double number) { fixed(std::bit_cast<std::uint64_t>(number), 8); }
  /// 7 bits a byte, the lowest first; the highest bit says that more follow.
  void varint(std::uint64_t number) {
    for (; number >= 0x80; number >>= 7) byte(static_cast<std::uint8_t>(number | 0x80));
    byte(static_cast<std::uint8_t>(number));
  }
  void bytes(Bytes bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

 private:
  std::vector<std::uint8_t>& out_;
};

/// After the first read beyond the end everything reads as zero and empty, and failed() is true.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes) {}

  bool failed() const { return failed_; }
  bool at_end() const { return rest_.empty(); }

  Bytes bytes(std::uint64_t count) {
    if (count > rest_.size()) {
      failed_ = true;
      rest_ = {};
      return {};
    }
    const Bytes taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  std::uint64_t fixed(int width) {
    std::uint64_t number = 0;
    int shift = 0;
    for (const std::uint8_t each : bytes(static_cast<std::uint64_t>(width))) {
      number |= std::uint64_t{each} << shift;
      shift += 8;
    }
    return number;
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(fixed(1)); }
  double real() { return std::bit_cast<double>(fixed(8)); }
  /// Bits beyond the 64th are dropped; an eleventh byte fails.
  std::uint64_t varint() {
    std::uint64_t number = 0;
    for (int shift = 0; shift < 70; shift += 7) {
      const std::uint8_t each = byte();
      number |= static_cast<std::uint64_t>(each & 0x7F) << shift;
      if (each < 0x80) return number;
    }
    failed_ = true;
    rest_ = {};
    return 0;
  }

 private:
  Bytes rest_;
  bool failed_ = false;
};

}  // namespace reident::storage
