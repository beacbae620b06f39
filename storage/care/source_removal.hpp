// Samples of one source taken out of the archive again, as those of a file whose clock was read
// wrongly.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage {

struct SourceRemovalReport {
  std::uint64_t samples = 0;  // removed
  std::uint64_t series = 0;   // that held some
};

/// Removes every sample that a source brought, in bounded transactions: a stopped removal is gone
/// on with by calling it again. Samples of other sources stay, but one that the source replaced by
/// a better quality does not come back. Requires an archive whose samples all are in chunks
/// (Archive::compact()). Throws Error where the file or the disk refuses.
SourceRemovalReport remove_source(Archive& archive, const std::string& spacecraft, Origin origin,
                                  const std::string& source);

/// An import in the log.
struct ImportedFile {
  std::int64_t id = 0;
  std::string file, request;  // as ImportLog::begin() got them
};
std::vector<ImportedFile> imported_files(const Database& database);
/// Forgets an import: its file is imported from the beginning again.
void forget_import(Database& database, std::int64_t id);

}  // namespace reident::storage
