// The bytes of a file as a stream of UTF-8 text, whatever its encoding. Files are opened for
// reading alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "service/support/csv.hpp"
#include "service/telemetry_file/encoding.hpp"

namespace reident::telemetry_file {

using csv::Error;

class TextSource {
 public:
  /// Opens a file whose encoding is given (a name that iconv knows) or found. An error where it
  /// cannot be read, is packed or no text, or the encoding is unknown.
  static std::variant<TextSource, Error> open(const std::filesystem::path& path,
                                              const std::optional<std::string>& encoding);
  /// Gives `text` itself; `name` stands for the file in messages.
  static TextSource of_text(std::string text, std::string name);

  /// Appends some text to `buffer`, nothing at the end. An error where the file cannot be read.
  std::optional<Error> read(std::string& buffer);
  /// Goes to a place in the text, in bytes of UTF-8.
  std::optional<Error> seek(std::uint64_t position);

  const std::string& name() const { return name_; }
  const std::string& encoding() const { return encoding_; }
  std::uint64_t size() const { return size_; }  // bytes of the file; 0 where it cannot be known
  bool can_seek() const { return file_ != nullptr; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::optional<Error> failed(std::string_view what) const;

  std::string name_, encoding_ = "UTF-8";
  std::unique_ptr<std::FILE, CloseFile> file_;  // null: `text_` is all there is
  std::unique_ptr<Decoder> decoder_;            // null: the bytes are UTF-8
  std::string text_;                            // read already, not yet given
  std::uint64_t size_ = 0;
};

}  // namespace reident::telemetry_file
