#include "service/satcs/gateway/bit_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace reident::satcs {
namespace {

using xtce::Coding;

std::uint64_t low_bits(std::uint32_t count) {
  return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

std::int64_t with_sign(std::uint64_t bits, std::uint32_t count) {
  const std::uint32_t above = 64 - count;
  return static_cast<std::int64_t>(bits << above) >> above;
}

std::uint64_t reversed(std::uint64_t bits, std::uint32_t count) {
  std::uint64_t result = 0;
  for (std::uint32_t i = 0; i < count; ++i) result |= ((bits >> i) & 1) << (count - 1 - i);
  return result;
}

/// The first byte is the least significant; the last one may have fewer bits.
std::uint64_t low_byte_first(std::uint64_t bits, std::uint32_t count) {
  std::uint64_t result = 0;
  for (std::uint32_t done = 0; done < count;) {
    const std::uint32_t width = std::min<std::uint32_t>(8, count - done);
    const std::uint64_t part = (bits >> (count - done - width)) & low_bits(width);
    result |= part << done;
    done += width;
  }
  return result;
}

double half(std::uint64_t bits) {
  const double sign = (bits & 0x8000U) != 0 ? -1 : 1;
  const int exponent = static_cast<int>((bits >> 10) & 0x1fU);
  const auto fraction = static_cast<double>(bits & 0x3ffU);
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  if (exponent == 31)
    return fraction == 0 ? sign * std::numeric_limits<double>::infinity()
                         : std::numeric_limits<double>::quiet_NaN();
  return sign * std::ldexp(fraction + 1024, exponent - 25);
}

double ieee(std::uint64_t bits, std::uint32_t count) {
  if (count == 16) return half(bits);
  if (count == 32)
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  return std::bit_cast<double>(bits);
}

/// A mantissa in two's complement, with its point behind the sign, and an 8-bit exponent behind the
/// first 24 bits of it.
double mil_std_1750a(std::uint64_t bits, std::uint32_t count) {
  if (count == 32) {
    const auto exponent = with_sign(bits & 0xffU, 8);
    return std::ldexp(static_cast<double>(with_sign(bits >> 8, 24)),
                      static_cast<int>(exponent) - 23);
  }
  const auto exponent = with_sign((bits >> 16) & 0xffU, 8);
  const std::uint64_t mantissa = ((bits >> 24) << 16) | (bits & 0xffffU);
  return std::ldexp(static_cast<double>(with_sign(mantissa, 40)), static_cast<int>(exponent) - 39);
}

RawNumber of_integer(std::int64_t value) {
  return {static_cast<double>(value), value};
}

}  // namespace

std::uint64_t bits_of(std::span<const std::uint8_t> bytes, std::uint64_t first,
                      std::uint32_t count) {
  std::uint64_t value = 0;
  for (std::uint32_t left = count; left > 0;) {
    const std::uint8_t byte = bytes[first / 8];
    const auto within = static_cast<std::uint32_t>(first % 8);
    const std::uint32_t taken = std::min(left, 8 - within);
    value = (value << taken) | ((std::uint64_t{byte} >> (8 - within - taken)) & low_bits(taken));
    first += taken;
    left -= taken;
  }
  return value;
}

RawNumber number_of(std::span<const std::uint8_t> bytes, std::uint64_t first,
                    const xtce::Encoding& encoding) {
  const auto count = static_cast<std::uint32_t>(encoding.size.bits);
  std::uint64_t bits = bits_of(bytes, first, count);
  if (encoding.low_bit_first) bits = reversed(bits, count);
  if (encoding.low_byte_first) bits = low_byte_first(bits, count);
  const bool is_negative = ((bits >> (count - 1)) & 1) != 0;
  switch (encoding.coding) {
    case Coding::twos_complement:
      return of_integer(with_sign(bits, count));
    case Coding::ones_complement:
      return of_integer(is_negative ? -static_cast<std::int64_t>(~bits & low_bits(count))
                                    : static_cast<std::int64_t>(bits));
    case Coding::sign_magnitude:
      return of_integer(is_negative ? -static_cast<std::int64_t>(bits & low_bits(count - 1))
                                    : static_cast<std::int64_t>(bits));
    case Coding::ieee754:
    case Coding::mil_std_1750a: {
      const double value =
          encoding.coding == Coding::ieee754 ? ieee(bits, count) : mil_std_1750a(bits, count);
      return {value, std::isfinite(value) && std::abs(value) < 9e18
                         ? static_cast<std::int64_t>(value)
                         : std::numeric_limits<std::int64_t>::max()};
    }
    default:
      constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
      return {static_cast<double>(bits), static_cast<std::int64_t>(std::min(bits, most))};
  }
}

}  // namespace reident::satcs
