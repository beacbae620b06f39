// What a disk may hold after the power failed: everything that was synced, and of the rest any
// part.
//
// In a file that was not synced, each write may be there, absent, or there in some of its sectors
// of 512 bytes; each truncation may be there or not. Names are kept by a journal, as ext4 and xfs
// keep them: of those made and removed since the last sync any first part is there. Syncing a file
// whose name is new puts the names on the disk as well.
#pragma once

#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/storage/database/watched_files.hpp"

namespace reident::storage::test {

class UnsafeDisk {
 public:
  /// Takes in the next operation, in the order in which they were asked for.
  void apply(const FileOperation& operation);

  /// Puts the files into `folder`, which is emptied first, as the power may leave them.
  void cut_power(const std::filesystem::path& folder, std::mt19937& random) const;

  /// How many operations would be lost if nothing but synced ones were there.
  std::size_t unsynced() const;

 private:
  struct File {
    std::string synced;
    std::vector<FileOperation> unsynced;
  };
  struct NameChange {
    std::string path;
    std::size_t file = none;  // none: the name was removed
  };
  using Names = std::map<std::string, std::size_t>;
  static constexpr std::size_t none = ~std::size_t{0};

  static void change(Names& names, const NameChange& change);
  void sync_names();
  void sync_file(const std::string& path);

  std::vector<File> files_;
  Names names_, synced_names_;
  std::vector<NameChange> unsynced_names_;
};

}  // namespace reident::storage::test
