// Which encoding the bytes of a text have, and the text in UTF-8.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace reident::telemetry_file {

/// Returns the encoding that the first bytes of a file show: a byte order mark; zeros in every
/// second byte (UTF-16); bytes that are no UTF-8 (WINDOWS-1252 where 0x80 to 0x9F occur, else
/// ISO-8859-1); else UTF-8. A character that is cut off at the end of `head` is no evidence.
std::string find_encoding(std::string_view head);

/// Returns the first word of a text in ISO-8859-1 or WINDOWS-1252 by find_encoding() that is none
/// of Western Europe: three bytes beyond ASCII side by side, or a sign within it. Empty where few
/// of such bytes stand so.
std::string foreign_word(std::string_view head);

/// Whether bytes are those of a packed or binary file: no text in any encoding. `encoding` is what
/// find_encoding() says of them.
bool is_binary(std::string_view head, std::string_view encoding);

/// Converts a stream of bytes to UTF-8. What the encoding does not know becomes U+FFFD.
class Decoder {
 public:
  /// Absent where the system does not know the encoding.
  static std::unique_ptr<Decoder> of(const std::string& encoding);
  ~Decoder();
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// Appends the next bytes to `text`, as far as characters are complete; at the end of the stream
  /// all of them.
  void decode(std::string_view bytes, bool at_end, std::string& text);

 private:
  explicit Decoder(void* handle) : handle_(handle) {}
  void* handle_;
  std::string rest_;  // the beginning of a character
};

}  // namespace reident::telemetry_file
