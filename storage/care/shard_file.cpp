#include "storage/care/shard_file.hpp"

#include <charconv>
#include <chrono>
#include <cstdio>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/chunks/checksum.hpp"
#include "storage/chunks/sample_gaps.hpp"
#include "storage/database/partial_file.hpp"
#include "storage/database/schema.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;

constexpr std::int64_t day = 86'400'000'000'000;

constexpr std::string_view chunks_of_year =
    "SELECT series, first_time, last_time, samples, step, gap_limit, least, greatest, data "
    "FROM chunk WHERE shard = 0 AND last_time BETWEEN ? AND ? ORDER BY series, first_time";

/// First and last time of a year, as far as there are such times.
std::pair<Time, Time> times_of(std::int64_t year) {
  const auto begin = [](std::int64_t of) {
    using namespace std::chrono;
    constexpr std::int64_t most_days = latest_time / day;
    const std::int64_t days =
        sys_days(std::chrono::year(static_cast<int>(of)) / 1 / 1).time_since_epoch().count();
    if (days < -most_days) return earliest_time;
    return days > most_days ? latest_time : days * day;
  };
  return {begin(year), begin(year + 1) - 1};
}

/// Counts what will be in the file, and names it.
std::optional<ShardFile> describe(Connection& database, std::int64_t year) {
  ShardFile file{.year = year};
  file.first = latest_time;
  file.last = earliest_time;
  std::vector<std::uint8_t> digests;
  const auto add = [&digests](std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8)
      digests.push_back(static_cast<std::uint8_t>(number >> shift));
  };
  ChunkBytes bytes(database);
  const auto [first, last] = times_of(year);
  sqlite::Query row = database.query(chunks_of_year, first, last);
  while (row.step()) {
    const auto data = bytes.read({0, row.integer(8)});
    if (data.empty()) continue;  // damage, which verify names, stays where it is
    ++file.chunks;
    file.samples += row.integer<std::uint64_t>(3);
    file.first = std::min(file.first, row.integer(1));
    file.last = std::max(file.last, row.integer(2));
    add(row.integer<std::uint64_t>(0));
    add(row.integer<std::uint64_t>(1));
    add(xxh64(data));
  }
  if (file.chunks == 0) return std::nullopt;
  char name[64];
  std::snprintf(name, sizeof name, "%lld-%016llx.db", static_cast<long long>(year),
                static_cast<unsigned long long>(xxh64(digests)));
  file.name = name;
  return file;
}

void copy_rows(Connection& from, Connection& to, const std::string& table) {
  sqlite::Query row = from.query("SELECT * FROM " + table);
  std::string places = "?";
  for (int column = 1; column < row.columns(); ++column) places += ", ?";
  sqlite::Query insert = to.query("INSERT INTO " + table + " VALUES (" + places + ")");
  std::vector<sqlite::Value> values;
  while (row.step()) {
    values.clear();
    for (int column = 0; column < row.columns(); ++column) values.push_back(row.value(column));
    insert.run(values);
  }
}

/// The gaps that a chunk, and the border to the one before it in the file, bring.
void copy_gaps(Connection& from, Connection& to, std::int64_t series, const SampleGap& inside) {
  sqlite::Query insert =
      to.query("INSERT INTO sample_gap (series, begin_time, end_time) VALUES (?, ?, ?)");
  sqlite::Query gap = from.query(
      "SELECT begin_time, end_time FROM sample_gap WHERE series = ? AND begin_time >= ? "
      "AND begin_time < ?",
      series, inside.begin, inside.end);
  while (gap.step()) insert.run(series, gap.integer(0), gap.integer(1));
}

void copy_chunks(Connection& from, Connection& to, std::int64_t year) {
  struct Before {
    std::int64_t series = 0;
    Time last = 0;
    Sampling sampling;
  };
  std::optional<Before> before;
  ChunkBytes bytes(from);
  const auto [first, last] = times_of(year);
  sqlite::Query row = from.query(chunks_of_year, first, last);
  while (row.step()) {
    const std::int64_t series = row.integer(0);
    const Sampling sampling{row.integer(4), row.integer(5)};
    const auto data = bytes.read({0, row.integer(8)});
    if (data.empty()) continue;
    to.query("INSERT INTO chunk_data (bytes) VALUES (?)").run(data);
    std::vector<sqlite::Value> values;
    for (int column = 0; column < 8; ++column) values.push_back(row.value(column));
    values.emplace_back(to.last_id());
    to.query(
          "INSERT INTO chunk (series, first_time, last_time, samples, step, gap_limit, least, "
          "greatest, data) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .run(values);
    if (before && before->series == series)
      if (const auto gap = gap_between(before->last, before->sampling, row.integer(1), sampling))
        to.query("INSERT INTO sample_gap (series, begin_time, end_time) VALUES (?, ?, ?)")
            .run(series, gap->begin, gap->end);
    copy_gaps(from, to, series, {row.integer(1), row.integer(2)});
    before = {series, row.integer(2), sampling};
  }
}

void fill(Connection& from, Connection& to, const ShardFile& file) {
  // A file that counts only when it is whole needs no journal; it is forced to the disk at the end.
  to.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  to.execute(schema::creation());
  sqlite::Transaction transaction(to);
  copy_rows(from, to, "parameter");
  copy_rows(from, to, "source");
  copy_rows(from, to, "series");
  copy_chunks(from, to, file.year);
  // Counts are those of what is here; sequence numbers stay with the database.
  to.query("UPDATE source SET missing = 0").run();
  to.query(
        "UPDATE series SET moved = 0, "
        "samples = (SELECT coalesce(sum(samples), 0) FROM chunk WHERE series = series.id), "
        "first_time = (SELECT min(first_time) FROM chunk WHERE series = series.id), "
        "last_time = (SELECT max(last_time) FROM chunk WHERE series = series.id)")
      .run();
  to.query("DELETE FROM series WHERE samples = 0").run();
  to.query(
        "INSERT INTO shard (id, file, first_time, last_time, chunks, all_chunks, bytes) "
        "VALUES (0, ?, ?, ?, ?, ?, 0)")
      .run(file.name, file.first, file.last, file.chunks, file.chunks);
  transaction.commit();
}

}  // namespace

bool has_content_of(Connection& shard, const std::string& name) {
  std::int64_t year = 0;
  std::from_chars(name.data(), name.data() + name.size(), year);
  const std::optional<ShardFile> found = describe(shard, year);
  return found && found->name == name;
}

std::optional<ShardFile> write_shard(Connection& database, std::int64_t year) {
  const sqlite::ReadTransaction snapshot(database);
  std::optional<ShardFile> file = describe(database, year);
  if (!file) return std::nullopt;
  const fs::path path = shard_path(database.path(), file->name);
  make_folder_of(path, fs::path(database.path()).parent_path());
  PartialFile partial(path, permissions_of(database.path()));
  {
    Connection target(partial.path().string(), partial.path(), SQLITE_OPEN_READWRITE);
    fill(database, target, *file);
  }
  partial.publish(true);
  file->bytes = fs::file_size(path);
  return file;
}

}  // namespace reident::storage
