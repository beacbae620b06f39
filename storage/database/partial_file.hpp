// A file that is written under another name until it is whole. Private to storage.
#pragma once

#include <filesystem>

#include <sys/types.h>

namespace reident::storage {

/// Permissions of a file that is to have those of `file`, and can be written by its owner.
mode_t permissions_of(const std::filesystem::path& file);

/// Makes the folder that `file` is in where there is none, with the permissions of the folder
/// `like`, which it is in. It is on the disk when this returns. Throws Error as PartialFile does.
void make_folder_of(const std::filesystem::path& file, const std::filesystem::path& like);

/// "<target>.partial": made empty, removed when this ends, unless it took the target's name. One
/// process at a time has it; what a killed one left is replaced.
class PartialFile {
 public:
  /// `mode` are the permissions of a new file, which the umask reduces. Throws Error: locked,
  /// read_only, full or cannot_open.
  PartialFile(const std::filesystem::path& target, mode_t mode);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Forces the content to the disk, takes the target's name, and forces the folder to the disk.
  /// What has that name is replaced, or else refused.
  void publish(bool replace);

 private:
  bool make(mode_t mode);
  void remove_what_was_left();

  std::filesystem::path target_, path_;
  int descriptor_ = -1;
  bool published_ = false;
};

}  // namespace reident::storage
