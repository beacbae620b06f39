#include "service/dds/wire.hpp"

#include <algorithm>
#include <cstring>

namespace reident::dds {
namespace {

/// Bytes of the sequence that starts with `lead` and the range of its second byte; 0 bytes where no
/// sequence starts so.
struct Utf8Form {
  std::size_t bytes = 0;
  unsigned char low = 0x80;
  unsigned char high = 0xbf;
};

Utf8Form form_of(unsigned char lead) {
  if (lead < 0x80) return {1, 0, 0};
  if (lead >= 0xc2 && lead <= 0xdf) return {2, 0x80, 0xbf};
  if (lead == 0xe0) return {3, 0xa0, 0xbf};
  if (lead == 0xed) return {3, 0x80, 0x9f};
  if (lead >= 0xe1 && lead <= 0xef) return {3, 0x80, 0xbf};
  if (lead == 0xf0) return {4, 0x90, 0xbf};
  if (lead >= 0xf1 && lead <= 0xf3) return {4, 0x80, 0xbf};
  if (lead == 0xf4) return {4, 0x80, 0x8f};
  return {};
}

bool has_control_character(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

}  // namespace

bool is_utf8(const std::string& text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto byte_at = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const Utf8Form form = form_of(byte_at(i));
    if (form.bytes == 0 || text.size() - i < form.bytes) return false;
    for (std::size_t k = 1; k < form.bytes; ++k) {
      const unsigned char low = k == 1 ? form.low : 0x80;
      const unsigned char high = k == 1 ? form.high : 0xbf;
      if (byte_at(i + k) < low || byte_at(i + k) > high) return false;
    }
    i += form.bytes;
  }
  return true;
}

std::string TextReader::text(const char* text, const char* field, std::size_t max_bytes) {
  if (text == nullptr) {
    if (!fault_) fault_ = std::string(field) + " is null";
    return {};
  }
  const std::size_t size = strnlen(text, max_bytes + 1);
  std::string copy(text, std::min(size, max_bytes));
  if (fault_) return copy;
  if (size > max_bytes) {
    fault_ = std::string(field) + " is longer than " + std::to_string(max_bytes) + " bytes";
  } else if (!is_utf8(copy)) {
    fault_ = std::string(field) + " is not UTF-8";
  }
  return copy;
}

std::string TextReader::name(const char* text, const char* field) {
  std::string copy = this->text(text, field);
  if (fault_) return copy;
  if (copy.empty()) {
    fault_ = std::string(field) + " is empty";
  } else if (copy.size() > max_name_bytes) {
    fault_ = std::string(field) + " is longer than " + std::to_string(max_name_bytes) + " bytes";
  } else if (has_control_character(copy)) {
    fault_ = std::string(field) + " has a control character";
  }
  return copy;
}

}  // namespace reident::dds
