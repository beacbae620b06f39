// The text of one file of the model cache; model_cache.hpp says what is in it. Nothing here throws
// for what a file holds or the disk does.
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "service/client/model_cache.hpp"

namespace reident {

/// Returns the file's text, one line. Requires a model that is sound (version_check.hpp).
std::string kept_version_text(const CachedVersion& kept, const std::string& partition);

/// Why a file gives no version.
struct Unusable {
  enum class Kind {
    absent,   // there is no such file
    damaged,  // to be set aside
    foreign   // of a newer program, or not ours to read: to be left as it is
  };
  Kind kind;
  std::string reason;  // for an operator, with the remedy where it is not damage
};

/// Reads and verifies the version in `file`: its SHA-256, its fields, and that it is sound. A file
/// of another partition, or of more than 64 MiB, is damaged.
std::variant<CachedVersion, Unusable> read_kept_version(const std::filesystem::path& file,
                                                        const std::string& partition);

}  // namespace reident
