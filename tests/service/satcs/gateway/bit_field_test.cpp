#include "service/satcs/gateway/bit_field.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace reident::test::bit_field_test {
namespace {

using satcs::bits_of;
using satcs::number_of;
using satcs::xtce::Coding;
using satcs::xtce::Encoding;
using Bytes = std::vector<std::uint8_t>;

double value(Coding coding, std::uint64_t bits, const Bytes& bytes, bool low_byte_first = false,
             bool low_bit_first = false, std::uint64_t first = 0) {
  Encoding encoding;
  encoding.coding = coding;
  encoding.size.bits = bits;
  encoding.low_byte_first = low_byte_first;
  encoding.low_bit_first = low_bit_first;
  return number_of(bytes, first, encoding).value;
}

TEST(BitField, TakesAnyBitsOfAnyBytes) {
  const Bytes bytes{0xb1, 0x2c, 0x7f, 0x00, 0xff, 0x80, 0x01, 0x23, 0x45};
  for (std::uint64_t first = 0; first <= 72; ++first) {
    for (std::uint32_t count = 0; count <= 64 && first + count <= 72; ++count) {
      std::uint64_t expected = 0;
      for (std::uint64_t bit = first; bit < first + count; ++bit)
        expected = expected << 1 | ((bytes[bit / 8] >> (7 - bit % 8)) & 1U);
      ASSERT_EQ(bits_of(bytes, first, count), expected) << first << " " << count;
    }
  }
}

TEST(BitField, KnowsTheCodingsOfIntegers) {
  EXPECT_EQ(value(Coding::unsigned_integer, 12, {0xff, 0xf0}), 4095);
  EXPECT_EQ(value(Coding::twos_complement, 12, {0xff, 0xf0}), -1);
  EXPECT_EQ(value(Coding::twos_complement, 12, {0x80, 0x00}), -2048);
  EXPECT_EQ(value(Coding::ones_complement, 8, {0xfe}), -1);
  EXPECT_EQ(value(Coding::ones_complement, 8, {0x7f}), 127);
  EXPECT_EQ(value(Coding::sign_magnitude, 8, {0x85}), -5);
  EXPECT_EQ(value(Coding::sign_magnitude, 8, {0x05}), 5);
  EXPECT_EQ(value(Coding::twos_complement, 1, {0x80}), -1);
  EXPECT_EQ(value(Coding::twos_complement, 64, Bytes(8, 0xff)), -1);
  EXPECT_EQ(value(Coding::unsigned_integer, 64, Bytes(8, 0xff)), 18446744073709551615.0);
}

TEST(BitField, KnowsTheOrdersOfBytesAndBits) {
  EXPECT_EQ(value(Coding::unsigned_integer, 16, {0x34, 0x12}, true), 0x1234);
  EXPECT_EQ(value(Coding::unsigned_integer, 24, {0x56, 0x34, 0x12}, true), 0x123456);
  EXPECT_EQ(value(Coding::unsigned_integer, 12, {0x34, 0x20}, true), 0x234);
  EXPECT_EQ(value(Coding::twos_complement, 16, {0xff, 0xff}, true), -1);
  EXPECT_EQ(value(Coding::unsigned_integer, 8, {0x01}, false, true), 0x80);
  EXPECT_EQ(value(Coding::unsigned_integer, 3, {0x80}, false, true), 1);
  EXPECT_EQ(value(Coding::ieee754, 32, {0x00, 0x00, 0x20, 0x41}, true), 10);
}

TEST(BitField, KnowsTheCodingsOfFloats) {
  EXPECT_EQ(value(Coding::ieee754, 32, {0x41, 0x20, 0x00, 0x00}), 10);
  EXPECT_EQ(value(Coding::ieee754, 64, {0xc0, 0x24, 0, 0, 0, 0, 0, 0}), -10);
  EXPECT_EQ(value(Coding::ieee754, 32, {0x20, 0x90, 0x00, 0x00, 0x00}, false, false, 1), 10);
  EXPECT_EQ(value(Coding::ieee754, 16, {0x3c, 0x00}), 1);
  EXPECT_EQ(value(Coding::ieee754, 16, {0xc5, 0x00}), -5);
  EXPECT_EQ(value(Coding::ieee754, 16, {0x00, 0x01}), std::ldexp(1, -24));
  EXPECT_EQ(value(Coding::ieee754, 16, {0x7c, 0x00}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(value(Coding::ieee754, 16, {0x7e, 0x00})));
  // Examples of the standard, its table of 32-bit numbers.
  EXPECT_EQ(value(Coding::mil_std_1750a, 32, {0x40, 0x00, 0x00, 0x01}), 1);
  EXPECT_EQ(value(Coding::mil_std_1750a, 32, {0x50, 0x00, 0x00, 0x04}), 10);
  EXPECT_EQ(value(Coding::mil_std_1750a, 32, {0x80, 0x00, 0x00, 0x00}), -1);
  EXPECT_EQ(value(Coding::mil_std_1750a, 32, {0x7f, 0xff, 0xff, 0x7f}),
            (1 - std::ldexp(1, -23)) * std::ldexp(1, 127));
  EXPECT_EQ(value(Coding::mil_std_1750a, 32, {0xa0, 0x00, 0x00, 0xff}), -0.375);
  EXPECT_EQ(value(Coding::mil_std_1750a, 48, {0x40, 0x00, 0x00, 0x01, 0x00, 0x01}),
            1 + std::ldexp(1, -38));
}

}  // namespace
}  // namespace reident::test::bit_field_test
