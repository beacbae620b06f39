#include "storage/archive/chunk_bytes.hpp"

#include "storage/types/utc_text.hpp"

namespace reident::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_open_shards = 16;  // one a year of a long mission

struct ListedShard {
  fs::path path;
  std::string file, what, remedy;
};

ListedShard listed(sqlite::Connection& database, std::int64_t id) {
  sqlite::Query row =
      database.query("SELECT file, first_time, last_time FROM shard WHERE id = ?", id);
  if (!row.step())
    throw Error(Error::Kind::corrupt, "database " + database.path() + " has chunks in a shard " +
                                          std::to_string(id) +
                                          " that its table shard does not list: restore a backup");
  ListedShard found{shard_path(database.path(), row.text(0)), row.text(0), {}, {}};
  found.what = "shard " + found.path.string() + ", which has telemetry from " +
               utc_text(row.integer(1)) + " to " + utc_text(row.integer(2)) + ", ";
  found.remedy = ": put the folder " + found.path.parent_path().string() +
                 " back, from a backup or from where the database " + database.path() +
                 " was before";
  return found;
}

ShardError cannot_be_read(const ListedShard& shard, const std::string& why) {
  return ShardError(shard.what + "cannot be read (" + why + ")" + shard.remedy);
}

sqlite::Connection opened(const ListedShard& shard) {
  std::error_code error;
  if (!fs::exists(shard.path, error)) throw ShardError(shard.what + "is missing" + shard.remedy);
  std::string name;
  try {
    sqlite::Connection connection(sqlite::immutable_uri(shard.path), shard.path,
                                  SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    {
      sqlite::Query row = connection.query("SELECT file FROM shard WHERE id = 0");
      if (row.step()) name = row.text(0);
    }
    if (name == shard.file) return connection;
  } catch (const Error& why) {
    throw cannot_be_read(shard, why.what());
  }
  throw ShardError(shard.what + "is another file: it says that it is '" + name + "'" +
                   shard.remedy);
}

}  // namespace

fs::path shard_path(const fs::path& database, const std::string& file) {
  return fs::path(database.string() + ".shards") / file;
}

sqlite::Connection& ChunkBytes::shard(std::int64_t id) {
  const auto found = open_.find(id);
  if (found != open_.end()) return found->second;
  if (open_.size() == most_open_shards) open_.clear();
  return open_.emplace(id, opened(listed(connection_, id))).first->second;
}

ShardError ChunkBytes::unreadable(std::int64_t id, const std::string& why) {
  open_.erase(id);  // the file may be put right
  return cannot_be_read(listed(connection_, id), why);
}

std::span<const std::uint8_t> ChunkBytes::read(ChunkPlace place) {
  if (place.shard == 0) return read(connection_, place.data);
  sqlite::Connection& file = shard(place.shard);
  try {
    return read(file, place.data);
  } catch (const Error& why) {
    throw unreadable(place.shard, why.what());
  }
}

std::span<const std::uint8_t> ChunkBytes::read(sqlite::Connection& file, std::int64_t data) {
  sqlite::Query row = file.query("SELECT bytes FROM chunk_data WHERE id = ?", data);
  bytes_.clear();
  if (!row.step()) return {};
  const auto found = row.bytes(0);
  bytes_.assign(found.begin(), found.end());
  return bytes_;
}

}  // namespace reident::storage
