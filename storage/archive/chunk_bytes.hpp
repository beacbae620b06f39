// The encoded bytes of chunks, in the database file or in one of its shards. Private to storage.
//
// A shard is an archive file of its own that never changes (storage/care/split.hpp). It is in the
// folder "<database>.shards". The database keeps the rows of all chunks; the columns `shard` and
// `data` say where the bytes of one are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "storage/database/sqlite.hpp"

namespace reident::storage {

/// Row `data` of the table chunk_data, in a shard or (0) in the database itself.
struct ChunkPlace {
  std::int64_t shard = 0;
  std::int64_t data = 0;
  bool operator==(const ChunkPlace&) const = default;
};

/// A shard is missing, cannot be read, or is another one. The message has the remedy.
class ShardError : public Error {
 public:
  explicit ShardError(const std::string& message) : Error(Kind::cannot_open, message) {}
};

/// Where a shard is, by the name that the table `shard` has.
std::filesystem::path shard_path(const std::filesystem::path& database, const std::string& file);

/// One thread at a time. Shards are opened when they are needed, and some stay open.
class ChunkBytes {
 public:
  /// The connection must outlive this object.
  explicit ChunkBytes(sqlite::Connection& connection) : connection_(connection) {}

  /// The bytes at `place`, valid until the next call; none where there is no such row. Throws
  /// ShardError.
  std::span<const std::uint8_t> read(ChunkPlace place);
  /// A shard that the database lists, opened for reading. Throws as read() does.
  sqlite::Connection& shard(std::int64_t id);
  /// What to throw where something in a shard is damaged.
  ShardError unreadable(std::int64_t id, const std::string& why);

 private:
  std::span<const std::uint8_t> read(sqlite::Connection& file, std::int64_t data);

  sqlite::Connection& connection_;
  std::map<std::int64_t, sqlite::Connection> open_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace reident::storage
