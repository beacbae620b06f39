#include "storage/care/split.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>

#include "storage/archive/archive_access.hpp"
#include "storage/care/shard_file.hpp"
#include "storage/database/connection.hpp"

namespace reident::storage {
namespace {

constexpr std::int64_t chunks_of_step = 256;

std::int64_t number_of(sqlite::Query row) {
  return row.step() ? row.integer(0) : 0;
}

/// Moves chunks of one shard, in the order of its rows.
class Move {
 public:
  Move(Archive& archive, std::int64_t shard)
      : archive_(archive),
        database_(connection(archive.database())),
        shard_(shard),
        bytes_(database_) {}

  /// Within one transaction. Absent when all were looked at; else how many moved.
  std::optional<std::uint64_t> step() {
    sqlite::Transaction transaction(database_);
    return archive_access(archive_.database()).write(archive_.options(), [&](Writer& writer) {
      std::uint64_t looked_at = 0, moved = 0;
      sqlite::Query row = bytes_.shard(shard_).query(
          "SELECT series, first_time, data, bytes FROM chunk JOIN chunk_data ON id = data "
          "WHERE (series, first_time) > (?, ?) ORDER BY series, first_time LIMIT ?",
          series_, first_, chunks_of_step);
      for (; row.step(); ++looked_at) {
        series_ = row.integer(0);
        first_ = row.integer(1);
        const auto chunk = writer.chunks().at_or_before(series_, first_);
        if (!chunk || chunk->first != first_ || chunk->place.shard != 0 ||
            !std::ranges::equal(bytes_.read(chunk->place), row.bytes(3)))
          continue;
        writer.chunks().move(*chunk, {shard_, row.integer(2)});
        ++moved;
      }
      transaction.commit();
      return looked_at == 0 ? std::nullopt : std::optional(moved);
    });
  }

 private:
  Archive& archive_;
  sqlite::Connection& database_;
  const std::int64_t shard_;
  ChunkBytes bytes_;
  std::int64_t series_ = std::numeric_limits<std::int64_t>::min();
  Time first_ = 0;
};

class Split {
 public:
  Split(Archive& archive, std::int64_t before,
        const std::function<bool(const SplitProgress&)>& go_on)
      : archive_(archive), database_(connection(archive.database())), go_on_(go_on) {
    sqlite::Query row = database_.query("SELECT last_time FROM chunk WHERE shard = 0");
    while (row.step())
      if (year_of(row.integer(0)) < before) {
        ++progress_.chunks;
        years_.insert(year_of(row.integer(0)));
      }
  }

  SplitReport run() {
    // What a split that was killed has not moved yet.
    std::vector<std::int64_t> begun;
    {
      sqlite::Query row =
          database_.query("SELECT id FROM shard WHERE id <> 0 AND chunks < all_chunks");
      while (row.step()) begun.push_back(row.integer(0));
    }
    for (const std::int64_t shard : begun)
      if (!years_.empty() && !move(shard)) return stopped();
    for (const std::int64_t year : years_) {
      const auto file = write_shard(database_, year);
      if (!file) continue;
      database_
          .query(
              "INSERT INTO shard (file, first_time, last_time, chunks, all_chunks, bytes) "
              "VALUES (?, ?, ?, 0, ?, ?) ON CONFLICT DO NOTHING")
          .run(file->name, file->first, file->last, file->chunks, file->bytes);
      report_.made.push_back({file->name, file->chunks, file->samples, file->bytes});
      if (!move(number_of(database_.query("SELECT id FROM shard WHERE file = ?", file->name))))
        return stopped();
    }
    return report_;
  }

 private:
  bool move(std::int64_t shard) {
    Move move(archive_, shard);
    while (go_on_(progress_)) {
      const auto moved = move.step();
      if (!moved) return true;
      progress_.done += *moved;
      report_.chunks += *moved;
    }
    return false;
  }
  SplitReport stopped() {
    report_.complete = false;
    return report_;
  }

  Archive& archive_;
  sqlite::Connection& database_;
  const std::function<bool(const SplitProgress&)>& go_on_;
  std::set<std::int64_t> years_;
  SplitProgress progress_;
  SplitReport report_;
};

}  // namespace

std::int64_t year_of(Time time) {
  using namespace std::chrono;
  const year_month_day date(floor<days>(sys_time<nanoseconds>(nanoseconds(time))));
  return static_cast<int>(date.year());
}

SplitReport split_by_year(Archive& archive, std::int64_t before,
                          const std::function<bool(const SplitProgress&)>& go_on) {
  return Split(archive, before, go_on).run();
}

void give_back_room(Database& database) {
  connection(database).execute("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)");
}

// The file goes first: a row without chunks names a file that nobody misses.
void remove_empty_shards(Archive& archive) {
  sqlite::Connection& database = connection(archive.database());
  std::vector<std::string> files;
  {
    sqlite::Query row = database.query("SELECT file FROM shard WHERE chunks = 0 AND id <> 0");
    while (row.step()) files.push_back(row.text(0));
  }
  for (const std::string& file : files) {
    std::error_code error;
    std::filesystem::remove(shard_path(archive.database().path(), file), error);
    if (!error) database.query("DELETE FROM shard WHERE file = ?").run(file);
  }
}

}  // namespace reident::storage
