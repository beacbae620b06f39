// The text of one file of the model cache; model_cache.hpp says what is in it.
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "service/client/model_cache.hpp"

namespace reident {

std::string kept_version_text(const CachedVersion& kept, const std::string& partition);

/// Why a file gives no version.
struct Unusable {
  enum class Kind {
    absent,   // there is no such file
    damaged,  // to be set aside
    foreign   // of a newer program, or not ours to read: to be left as it is
  };
  Kind kind;
  std::string reason;
};

/// Reads and verifies the version in `file`, which must be of `partition`.
std::variant<CachedVersion, Unusable> read_kept_version(const std::filesystem::path& file,
                                                        const std::string& partition);

}  // namespace reident
