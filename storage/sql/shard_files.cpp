#include "storage/sql/shard_files.hpp"

#include <string>

namespace reident::storage::sql {
namespace {

constexpr std::size_t most_open_shards = 16;

/// A name for SQLite of a file that does not change.
std::string uri_of(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path)
    uri += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
  return uri + "?immutable=1";
}

}  // namespace

ShardFiles::Shard ShardFiles::open(std::int64_t id) const {
  Statement named(archive_, "SELECT file FROM main.shard WHERE id = ?1");
  const std::string file(named.bind(id).step() ? named.text(0) : "");
  const std::string path = std::string(sqlite3_db_filename(archive_, "main")) + ".shards/" + file;
  Shard shard;
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(uri_of(path).c_str(), &opened,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  shard.file.reset(opened);
  std::string found;
  if (code == SQLITE_OK) try {
      Statement itself(opened, "SELECT file FROM shard WHERE id = 0");
      if (itself.step()) found = itself.text(0);
    } catch (const QueryError&) {
      // Not a shard, which the name says below.
    }
  if (file.empty() || found != file)
    throw QueryError(SQLITE_CANTOPEN,
                     "telemetry: the shard " + path +
                         " is missing or is another file: put the folder back beside the archive, "
                         "from a backup or from where the archive was before");
  shard.bytes = std::make_unique<Statement>(opened, "SELECT bytes FROM chunk_data WHERE id = ?1");
  return shard;
}

Statement& ShardFiles::bytes_of(std::int64_t id) {
  auto place = open_.find(id);
  if (place == open_.end()) {
    if (open_.size() == most_open_shards) open_.clear();
    place = open_.emplace(id, open(id)).first;
  }
  return *place->second.bytes;
}

}  // namespace reident::storage::sql
