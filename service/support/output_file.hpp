// Text on its way into a file or to standard output, with errors that say what would mend them.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace reident {

/// The file has its name when all of it is there and on the disk: until then it is
/// "<name>.part", which goes away with the object. Calls throw std::runtime_error with file and
/// remedy. One thread at a time.
class OutputFile {
 public:
  enum class Existing { replaced, kept };

  /// Begins the file; its permissions are those of the umask. A file of that name that is there is
  /// replaced, or else kept, also one that comes meanwhile: then finish() throws. Throws for a
  /// folder, for what is no regular file, and where "<name>.part" cannot be written.
  explicit OutputFile(std::filesystem::path path, Existing existing = Existing::replaced);
  /// Standard output, where a reader may go away at any time: SIGPIPE must be ignored.
  static OutputFile standard_output();
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  /// Writes all of `text`. Throws where there is no room, or where the reader of standard output
  /// went away.
  void write(std::string_view text);
  /// Forces the file to the disk and gives it its name; nothing can be written afterwards. Without
  /// this call nothing is left of the file. Has no effect on standard output.
  void finish();

 private:
  OutputFile() = default;
  std::filesystem::path part() const;
  /// Renames the part; false, with errno, where that failed.
  bool take_name() const;
  [[noreturn]] void fail(int code) const;

  std::optional<std::filesystem::path> path_;  // absent: standard output
  Existing existing_ = Existing::replaced;
  int descriptor_ = -1;
};

}  // namespace reident
