// What storage throws.
//
// Storage throws an Error where it cannot do what it was asked to. What is only absent (a series, a
// version, a champion) is returned as such and never thrown. Whatever is thrown, nothing that was
// committed is lost.
#pragma once

#include <stdexcept>
#include <string>

namespace reident::storage {

/// A failure with what, where and what would mend it, as one text for an operator.
class Error : public std::runtime_error {
 public:
  /// What a caller may act upon; the message has the rest.
  enum class Kind {
    /// No such file, a folder, not ours, no permission.
    cannot_open,
    /// Another process writes.
    locked,
    /// Made by a newer program.
    newer_schema,
    /// Made by an older program and opened to be read alone.
    older_schema,
    /// Damaged or cut short.
    corrupt,
    /// No room on the disk, in the quota or in the file size limit.
    full,
    /// The file, its folder or the connection cannot be written.
    read_only,
    /// Deleted, moved or replaced while it was open.
    displaced,
    /// Anything else; the message has SQLite's own words.
    failed
  };
  /// `message` names the file or object, what is wrong with it, and the remedy.
  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace reident::storage
