// The shards of the archive that a connection opened: files with the bytes of chunks of closed
// years (storage/care/split.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "storage/sql/sqlite_api.hpp"

namespace reident::storage::sql {

/// Opens a shard when it is needed, and closes all at its end. Shards never change: what is read
/// of them belongs to any state of the archive that names them.
class ShardFiles {
 public:
  explicit ShardFiles(sqlite3* archive) : archive_(archive) {}

  /// The statement that gives the bytes of a chunk by its row ?1. Throws QueryError where the shard
  /// is missing or is another file.
  Statement& bytes_of(std::int64_t shard);

 private:
  struct Close {
    void operator()(sqlite3* file) const { sqlite3_close_v2(file); }
  };
  struct Shard {
    std::unique_ptr<sqlite3, Close> file;
    std::unique_ptr<Statement> bytes;
  };
  Shard open(std::int64_t shard) const;

  sqlite3* archive_;
  std::map<std::int64_t, Shard> open_;
};

}  // namespace reident::storage::sql
