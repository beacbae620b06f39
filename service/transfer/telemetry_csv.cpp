#include "service/transfer/telemetry_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::transfer {
namespace {

bool same_words(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    const auto plain = [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c == '_' ? ' ' : c;
    };
    return plain(x) == plain(y);
  });
}

template <class T, std::size_t count>
std::optional<T> by_name(std::string_view cell, const std::array<T, count>& all) {
  for (const T one : all)
    if (same_words(trimmed(cell), storage::name(one))) return one;
  return std::nullopt;
}

}  // namespace

std::optional<storage::Quality> parse_quality(std::string_view cell) {
  return by_name(cell, storage::qualities);
}

std::optional<storage::Origin> parse_origin(std::string_view cell) {
  return by_name(cell, std::array{storage::Origin::real, storage::Origin::simulated});
}

void append_value(std::string& line, double value) {
  if (std::isnan(value)) {
    line += "nan";
    return;
  }
  std::array<char, 32> text;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  line.append(text.data(), written.ptr);
}

void append_time(std::string& line, storage::Time time) {
  line += time_text(time);
}

void append_text(std::string& line, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos && trimmed(text) == text) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) {
    if (c == '"') line += '"';
    line += c;
  }
  line += '"';
}

}  // namespace reident::transfer
