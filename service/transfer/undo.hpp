// An import taken back.
#pragma once

#include <filesystem>
#include <variant>

#include "service/support/csv.hpp"
#include "storage/care/source_removal.hpp"

namespace reident::transfer {

/// Removes the samples that imports of `file` brought, by the import log, and forgets these
/// imports: the file can be imported again, read in another way. Descriptors stay. An error where
/// the log has no import of the file, its samples say themselves what they come from, or another
/// file's samples have the same source. Requires a database that is open for writing. Throws
/// storage::Error.
std::variant<storage::SourceRemovalReport, csv::Error> undo_import(
    storage::Database& database, const std::filesystem::path& file);

}  // namespace reident::transfer
