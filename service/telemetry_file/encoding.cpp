#include "service/telemetry_file/encoding.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <iconv.h>
#include <set>

namespace reident::telemetry_file {
namespace {

// Shares of the bytes of a text: a disk or link that failed leaves NUL bytes, nothing leaves
// others.
constexpr double most_nuls = 0.3, most_controls = 0.02;
constexpr std::string_view replacement = "\xEF\xBF\xBD";

unsigned at(std::string_view text, std::size_t index) {
  return static_cast<unsigned char>(text[index]);
}

/// Bytes of the character that begins with `first`; 0 where none does in UTF-8.
std::size_t utf8_length(unsigned first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(at(text, i));
    if (length == 0) return false;
    for (std::size_t k = 1; k < length; ++k) {
      if (i + k == text.size()) return true;  // cut off
      if ((at(text, i + k) & 0xC0U) != 0x80) return false;
    }
    i += length;
  }
  return true;
}

/// Whether the bytes beyond ASCII are characters of two bytes in Shift JIS, most of which have none
/// of ASCII: in Windows-1252, signs such as quotes and dashes stand beside letters.
bool is_shift_jis(std::string_view text) {
  std::size_t wide = 0, others = 0;  // pairs of bytes beyond ASCII, and what else goes beyond it
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned first = at(text, i);
    if (first < 0x80) continue;
    const bool leads = (first >= 0x81 && first <= 0x9F) || (first >= 0xE0 && first <= 0xFC);
    if (!leads || i + 1 == text.size()) {
      if (first < 0xA1 || first > 0xDF) return i + 1 == text.size() && wide > others;
      ++others;  // a half-width katakana
      continue;
    }
    const unsigned second = at(text, ++i);
    if (second < 0x40 || second == 0x7F || second > 0xFC) return false;
    ++(first <= 0x9F && second >= 0x80 ? wide : others);
  }
  return wide > others;
}

/// Signs that stand within no word of Western Europe, and are letters elsewhere.
constexpr std::string_view western_signs = "\xA3\xA5\xAA\xAF\xB3\xB9\xBA\xBC\xBE\xBF";
/// One in so many bytes beyond ASCII shows by its place what all are.
constexpr std::size_t least_share = 3;

bool is_letter(unsigned byte) {
  return (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z');
}

/// Letters and bytes beyond ASCII, from the first of them on.
std::string_view word_around(std::string_view text, std::size_t place) {
  const auto belongs = [&](std::size_t i) { return at(text, i) >= 0x80 || is_letter(at(text, i)); };
  std::size_t begin = place, end = place;
  while (begin > 0 && belongs(begin - 1)) --begin;
  while (end < text.size() && belongs(end)) ++end;
  return text.substr(begin, end - begin);
}

/// The shares of zeros at even and odd places.
std::array<double, 2> zeros(std::string_view head) {
  std::array<double, 2> counts = {0, 0};
  for (std::size_t i = 0; i < head.size(); ++i) counts[i % 2] += head[i] == '\0' ? 1 : 0;
  const double half = std::max(1.0, static_cast<double>(head.size()) / 2);
  return {counts[0] / half, counts[1] / half};
}

}  // namespace

std::string find_encoding(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.starts_with("\xFF\xFE\0\0"sv)) return "UTF-32LE";
  if (head.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32BE";
  if (head.starts_with("\xFF\xFE")) return "UTF-16LE";
  if (head.starts_with("\xFE\xFF")) return "UTF-16BE";
  const auto [even, odd] = zeros(head);
  if (odd > 0.7 && even < 0.2) return "UTF-16LE";
  if (even > 0.7 && odd < 0.2) return "UTF-16BE";
  if (is_utf8(head)) return "UTF-8";
  if (is_shift_jis(head)) return "SHIFT_JIS";
  const bool has_c1 = std::any_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x80 && static_cast<unsigned char>(c) < 0xA0;
  });
  return has_c1 ? "WINDOWS-1252" : "ISO-8859-1";
}

std::string foreign_word(std::string_view head) {
  std::size_t all = 0, in_words = 0;
  std::string_view first;
  std::set<std::string_view> seen;
  for (std::size_t begin = 0; begin < head.size();) {
    std::size_t end = begin;
    while (end < head.size() && at(head, end) >= 0x80) ++end;
    const std::string_view bytes = head.substr(begin, end - begin);
    const bool is_sign = bytes.size() == 1 && begin > 0 && is_letter(at(head, begin - 1)) &&
                         end < head.size() && is_letter(at(head, end)) &&
                         western_signs.find(bytes.front()) != std::string_view::npos;
    begin = std::max(end, begin + 1);
    if (bytes.empty()) continue;
    if (!seen.insert(is_sign ? western_signs : bytes).second) continue;
    all += bytes.size();
    if (bytes.size() >= 3 || is_sign) {
      in_words += is_sign ? least_share : bytes.size();
      if (first.empty()) first = word_around(head, end - bytes.size());
    }
  }
  return least_share * in_words >= all ? std::string(first) : "";
}

bool is_binary(std::string_view head, std::string_view encoding) {
  if (head.starts_with("\x1F\x8B") || head.starts_with("PK\x03\x04")) return true;
  if (encoding.starts_with("UTF-16") || encoding.starts_with("UTF-32")) return false;
  const auto nuls = std::count(head.begin(), head.end(), '\0');
  const auto controls = std::count_if(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\0' && c != '\n' && c != '\r' && c != '\t';
  });
  const auto size = static_cast<double>(head.size());
  return static_cast<double>(nuls) > most_nuls * size ||
         static_cast<double>(controls) > most_controls * size;
}

std::unique_ptr<Decoder> Decoder::of(const std::string& encoding) {
  iconv_t handle = iconv_open("UTF-8", encoding.c_str());
  if (handle == reinterpret_cast<iconv_t>(-1)) return nullptr;
  return std::unique_ptr<Decoder>(new Decoder(handle));
}

Decoder::~Decoder() {
  iconv_close(static_cast<iconv_t>(handle_));
}

void Decoder::decode(std::string_view bytes, bool at_end, std::string& text) {
  std::string input = rest_ + std::string(bytes);
  rest_.clear();
  char* from = input.data();
  std::size_t left = input.size();
  std::array<char, 4096> block;
  while (left > 0) {
    char* to = block.data();
    std::size_t room = block.size();
    const bool done = iconv(static_cast<iconv_t>(handle_), &from, &left, &to, &room) !=
                      static_cast<std::size_t>(-1);
    const int code = errno;
    text.append(block.data(), block.size() - room);
    if (done || code == E2BIG) continue;
    if (code == EINVAL && !at_end) break;
    text += replacement;
    ++from;
    --left;
  }
  rest_.assign(from, left);
}

}  // namespace reident::telemetry_file
