// Text on its way into a file or to standard output, with errors that say what would mend them.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace reident {

/// The file has its name when all of it is there and on the disk: until then it is
/// "<name>.part", which goes away with the object. Calls throw std::runtime_error with file and
/// remedy.
class OutputFile {
 public:
  enum class Existing { replaced, kept };

  /// A file of that name that is there is replaced, or else kept, also one that comes meanwhile:
  /// then finish() throws.
  explicit OutputFile(std::filesystem::path path, Existing existing = Existing::replaced);
  /// Standard output, where a reader may go away at any time: SIGPIPE must be ignored.
  static OutputFile standard_output();
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  void write(std::string_view text);
  void finish();

 private:
  OutputFile() = default;
  std::filesystem::path part() const;
  bool take_name() const;
  [[noreturn]] void fail(int code) const;

  std::optional<std::filesystem::path> path_;  // absent: standard output
  Existing existing_ = Existing::replaced;
  int descriptor_ = -1;
};

}  // namespace reident
