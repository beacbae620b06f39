// Doubles of one parameter in few bytes, every bit of them. Private to storage.
//
// The values of telemetry are few: each distinct one is a level. Levels become integers (decimals,
// steps of an affine calibration, or their rank in a table), whichever gives the fewest bytes;
// where they are too many for that, the bits of the doubles do. CHUNK.md has the format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "storage/chunks/integer_codec.hpp"
#include "storage/chunks/value_steps.hpp"

namespace reident::storage {

enum class ValueScheme : std::uint8_t { decimal = 0, affine = 1, table = 2, bits = 3 };

class ValueEncoder {
 public:
  explicit ValueEncoder(IntegerEncoder& integers) : integers_(integers) {}

  /// Puts values, at least one, into `out` and returns the scheme that was used.
  ValueScheme put(std::span<const double> values, std::vector<std::uint8_t>& out);

 private:
  void find_levels(std::span<const double> values);
  void split_levels();
  void put_steps(std::size_t count);
  void put_decimal(const DecimalSteps& steps);
  void put_affine(const AffineSteps& steps);
  void put_table(const std::optional<AffineSteps>& near);
  void put_bits(std::span<const double> values);
  void put_exceptions();
  void put_numbers(std::span<const std::int64_t> of_level);
  void consider(ValueScheme scheme);

  IntegerEncoder& integers_;
  std::vector<double> levels_;           // distinct, in the order in which they came
  std::vector<std::uint32_t> level_of_;  // index into levels_, of each value
  std::vector<double> countable_;        // those of levels_ that a formula can give
  std::vector<std::int64_t> slot_of_;    // index into countable_ of each level, or exception
  std::vector<std::uint32_t> buckets_, sorted_;
  std::vector<std::int64_t> numbers_, positions_;
  std::vector<std::uint8_t> candidate_, best_;
  ValueScheme best_scheme_ = ValueScheme::bits;
};

class ValueDecoder {
 public:
  explicit ValueDecoder(IntegerDecoder& integers) : integers_(integers) {}

  /// Values [first, first + out.size()) of the `count` that `in` stands at. False if the bytes do
  /// not hold such values. Needs up to 32 bytes for each of `count` on top of those of the
  /// integers.
  bool get(ByteReader& in, std::size_t count, std::size_t first, std::span<double> out);

 private:
  bool get_table(ByteReader& in, std::size_t count);
  bool get_exceptions(ByteReader& in, std::size_t count);
  template <class Function>
  void fill(std::span<double> out, Function value_of) const;
  void patch(std::size_t first, std::span<double> out) const;

  IntegerDecoder& integers_;
  std::vector<std::int64_t> numbers_, positions_, bits_;
  std::vector<double> table_;
};

}  // namespace reident::storage
