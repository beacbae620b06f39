// The last good version of each equipment in a folder, so that a simulator starts without a
// service.
//
//   <folder>/<partition>/<spacecraft>,<equipment>.json
//
// Names are percent-encoded (all but ASCII letters, digits, - and _); one that would be too long
// for a file name is cut and ends in ~ and the SHA-256 of the whole. A file is one JSON object:
// "format" (1), "sha256" (of the text of "kept" without blanks), and "kept": partition, number,
// digest, decided_ns, decided_by, rollback, program_version, published_ns, received_ns, model
// (service/model/model_json.hpp). It is written next to its place, flushed to the disk and renamed.
//
// Several simulators may share the folder: reading what is there, deciding and replacing it happen
// under a lock of the folder (flock), which goes with the process that holds it. A newer version is
// not replaced by an older one unless that is a rollback.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/model/model_version.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// A version and where it comes from.
struct CachedVersion {
  ModelVersion version;
  storage::Time published = 0;  // when the service sent it, by its clock; 0 where not known
  storage::Time received = 0;   // by the clock of the simulator that received it
};

/// What could not be read or written, why and what would mend it. `equipment` is empty where it is
/// not about one.
struct CacheFault {
  storage::EquipmentName equipment;
  std::string reason;
};

/// No call throws for what the disk does, and none waits longer than a second for another program.
class ModelCache {
 public:
  using Report = std::function<void(const CacheFault&)>;

  ModelCache(std::filesystem::path folder, std::string partition);

  /// $XDG_CACHE_HOME/reident, else $HOME/.cache/reident; absent where neither names an absolute
  /// path.
  static std::optional<std::filesystem::path> default_folder();

  /// The versions of the partition that are sound (version_check.hpp). What is damaged, or is of
  /// another equipment than its name says, is renamed to <name>.damaged and reported; what a newer
  /// program wrote, or cannot be read, is left and reported.
  std::vector<CachedVersion> load(const Report& report);

  /// Keeps a version that was verified, unless what is kept is as new. A fault is reported once,
  /// and again only when it changes or came back after a success.
  void store(const CachedVersion& kept, const Report& report);

  /// Where the version of an equipment is kept.
  std::filesystem::path file_of(const storage::EquipmentName& equipment) const;

 private:
  /// Empty when it was kept, or what is there is as new.
  std::string try_to_store(const CachedVersion& kept) const;

  std::filesystem::path folder_;  // of the partition
  std::string partition_;
  std::map<storage::EquipmentName, std::string> faults_;  // reported and not mended since
};

}  // namespace reident
