// An archive of many years in shards, one file a year, read as one.
//
// The rows of all chunks stay in the database, a hundred bytes each; the bytes of the chunks of
// closed years move to files that never change. Whatever is read is the same to the bit. Late
// samples of a closed year go into the database, with the chunk that they land in. SCHEMA.md,
// "Shards", has the rules.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage {

/// The year of `time` in UTC.
std::int64_t year_of(Time time);

/// How far a split is: chunks that are to move, and those that did.
struct SplitProgress {
  std::uint64_t chunks = 0;
  std::uint64_t done = 0;
};

struct SplitReport {
  struct Shard {
    std::string file;  // in the folder "<database>.shards"
    std::uint64_t chunks = 0, samples = 0, bytes = 0;
  };
  std::vector<Shard> made;
  std::uint64_t chunks = 0;  // that moved, those of a split that was stopped too
  bool complete = true;      // false when it was stopped
};

/// Moves the chunks that end before the year `before` into shards. A shard is on the disk before
/// the database refers to it, and the bytes of a chunk leave the database in the transaction that
/// says where they are, after they were compared: a stopped or killed split loses nothing, and the
/// next one goes on. `go_on` is asked between transactions. Requires an archive whose samples all
/// are in chunks (Archive::compact()). Throws Error where a file or the disk refuses.
SplitReport split_by_year(Archive& archive, std::int64_t before,
                          const std::function<bool(const SplitProgress&)>& go_on);

/// Gives the room that a split left in the database file back to the disk. Takes as much room again
/// as is in use, for the time that it works. Throws Error where there is none.
void give_back_room(Database& database);

/// Removes the files of shards from which nothing is read any more, as retention leaves them.
void remove_empty_shards(Archive& archive);

}  // namespace reident::storage
