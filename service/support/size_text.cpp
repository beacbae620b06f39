#include "service/support/size_text.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "service/support/text.hpp"

namespace reident {
namespace {

struct SizeUnit {
  std::string_view name;
  double bytes;
};

constexpr std::array size_units{
    SizeUnit{"TB", 1e12},    SizeUnit{"GB", 1e9},     SizeUnit{"MB", 1e6},
    SizeUnit{"kB", 1e3},     SizeUnit{"B", 1},        SizeUnit{"TiB", 0x1p40},
    SizeUnit{"GiB", 0x1p30}, SizeUnit{"MiB", 0x1p20}, SizeUnit{"KiB", 0x1p10}};
constexpr std::size_t decimal_units = 5;
constexpr double most_bytes = 0x1p63;

}  // namespace

std::optional<std::uint64_t> parse_size(std::string_view text) {
  text = trimmed(text);
  double number = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  if (error != std::errc() || !(number >= 0)) return std::nullopt;
  const std::string_view unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  for (const SizeUnit& one : size_units)
    if (unit == one.name && number * one.bytes < most_bytes)
      return static_cast<std::uint64_t>(std::llround(number * one.bytes));
  return std::nullopt;
}

std::string size_text(std::uint64_t bytes) {
  for (std::size_t i = 0; i + 1 < decimal_units; ++i)
    if (static_cast<double>(bytes) >= size_units[i].bytes)
      return fmt::format("{:.3g} {}", static_cast<double>(bytes) / size_units[i].bytes,
                         size_units[i].name);
  return fmt::format("{} B", bytes);
}

}  // namespace reident
