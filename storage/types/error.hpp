// What storage throws.
#pragma once

#include <stdexcept>
#include <string>

namespace reident::storage {

/// What, where and what would mend it. Thrown for a file that cannot be used, a full disk and the
/// like; nothing that was committed is lost.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    cannot_open,   // no such file, a folder, not ours, no permission
    locked,        // another process writes
    newer_schema,  // made by a newer program
    older_schema,  // made by an older program and opened to be read alone
    corrupt,       // damaged or cut short
    full,          // no room on the disk, in the quota or in the file size limit
    read_only,     // the file, its folder or the connection cannot be written
    displaced,     // deleted, moved or replaced while it was open
    failed         // anything else; the message has SQLite's own words
  };
  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace reident::storage
