// A sequence of 64-bit integers in few bytes: times, steps of values, qualities and sources are all
// of this kind. Private to storage.
//
// What repeats is folded into runs where that pays; what is left is taken from the smallest (order
// 0), from its predecessor (1) or from the line through its two predecessors (2), in units of its
// greatest common divisor. The bytes of the differences go to zstd plane by plane, the lowest
// first. All arithmetic is modulo 2^64, so every sequence comes back. CHUNK.md has the format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "storage/chunks/bytes.hpp"
#include "storage/chunks/compression.hpp"

namespace reident::storage {

/// Encodes one sequence after the other and keeps its memory between them.
class IntegerEncoder {
 public:
  explicit IntegerEncoder(int level) : compressor_(level) {}

  /// Puts a sequence that is not empty into `out`, in the smallest form that was found.
  void put(std::span<const std::int64_t> numbers, std::vector<std::uint8_t>& out);

 private:
  struct Form {
    bool runs = false;
    int order = 0;
    double estimate = 0;  // bytes, by the entropy of the planes
  };
  void scale(std::span<const std::int64_t> numbers);
  void fold();
  void plan(bool runs);
  void put_form(const Form& form, std::vector<std::uint8_t>& out);
  void put_planes(std::span<const std::uint64_t> words, std::vector<std::uint8_t>& out);

  Compressor compressor_;
  std::vector<Form> forms_;
  // number = base + unit * y; runs are of heads, each 1 + length long
  std::int64_t base_ = 0;
  std::uint64_t unit_ = 1;
  std::vector<std::uint64_t> ys_, heads_, lengths_, words_;
  std::vector<std::uint8_t> planes_, candidate_, best_;
};

class IntegerDecoder {
 public:
  /// Numbers [first, first + out.size()) of the `count` that `in` stands at. False if the bytes do
  /// not hold such a sequence. Needs up to 24 bytes for each of `count`, whatever the bytes say.
  bool get(ByteReader& in, std::size_t count, std::size_t first, std::span<std::int64_t> out);

  /// The number that all of `count`, not 0, are, where the form says so at once; `in` then stands
  /// behind it. Absent, and `in` where it was, for any other sequence.
  static std::optional<std::int64_t> get_constant(ByteReader& in, std::size_t count);

 private:
  bool get_planes(ByteReader& in, std::size_t count, std::vector<std::uint64_t>& words);

  Decompressor decompressor_;
  std::vector<std::uint8_t> planes_;
  std::vector<std::uint64_t> words_, lengths_;
};

}  // namespace reident::storage
