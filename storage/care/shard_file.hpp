// Makes a shard: an archive file with the chunks of one year, which never changes. Private to
// storage.
//
// It has the tables of any archive, so that it can be read by itself: series, chunks, gaps between
// them, descriptors and sources, and no registry. Its row 0 of the table `shard` names it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "storage/database/sqlite.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

struct ShardFile {
  std::string name{};  // the year and a digest of what is in it: no other content has this name
  std::int64_t year = 0;
  Time first = 0, last = 0;
  std::uint64_t chunks = 0, samples = 0;
  std::uint64_t bytes = 0;  // of the file
};

/// Writes the chunks that are in the database itself and end in `year`. Absent where there are
/// none. The file is whole and on the disk when this returns; a file of the name is replaced.
/// Throws Error where the database or the disk refuses.
std::optional<ShardFile> write_shard(sqlite::Connection& database, std::int64_t year);

/// Whether the chunks in `shard` are those that its name was made of. Reads all of them. Throws
/// Error where it cannot.
bool has_content_of(sqlite::Connection& shard, const std::string& name);

}  // namespace reident::storage
