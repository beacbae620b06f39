// Between the generated C types and C++: views for writing, and checked copies for reading.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace reident::dds {

/// Why a message breaks the contract of idl/README.md; empty when it keeps it.
using Fault = std::optional<std::string>;

/// Bounds of names and of other texts, without the final zero.
inline constexpr std::size_t max_name_bytes = 255;
inline constexpr std::size_t max_text_bytes = 65535;

/// Returns the text as the wire's type. The middleware writes from it and never into it, though its
/// type says char*. `text` has to live and stay until the wire sample was written.
inline char* borrow(const std::string& text) {
  return const_cast<char*>(text.c_str());
}

/// Returns a sequence of the wire that borrows the vector's elements; it does not release them. The
/// vector must not grow until the wire sample was written.
template <class Sequence, class T>
Sequence borrow(std::vector<T>& values) {
  Sequence sequence{};
  sequence._maximum = static_cast<std::uint32_t>(values.size());
  sequence._length = sequence._maximum;
  sequence._buffer = values.data();
  sequence._release = false;
  return sequence;
}

/// Copies texts of one message and remembers the first that is not usable. Never reads beyond the
/// bound of a text: it need not end.
class TextReader {
 public:
  /// 1 to max_name_bytes bytes of UTF-8 without control characters.
  std::string name(const char* text, const char* field);
  /// 0 to max_bytes bytes of UTF-8.
  std::string text(const char* text, const char* field, std::size_t max_bytes = max_text_bytes);
  /// What was wrong with the first bad text, with its field; empty as long as all were good.
  const Fault& fault() const { return fault_; }

 private:
  Fault fault_;
};

/// Whether the bytes are UTF-8 by RFC 3629: no overlong forms, no surrogates, nothing above
/// U+10FFFF.
bool is_utf8(const std::string& text);

}  // namespace reident::dds
