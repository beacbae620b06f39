#include "storage/archive/damage.hpp"

#include "storage/types/utc_text.hpp"

namespace reident::storage {

Error damage(sqlite::Connection& connection, const SampleRange& where, const ChunkError& error) {
  sqlite::Query name = connection.query(
      "SELECT coalesce(name, CAST(series.parameter AS TEXT)) || ' of ' || series.spacecraft "
      "FROM series LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft "
      "AND parameter.id = series.parameter WHERE series.id = ?",
      where.series);
  const std::string what = "database " + connection.path() + ": " + std::to_string(where.samples) +
                           " samples of " +
                           (name.step() ? name.text(0) : "series " + std::to_string(where.series)) +
                           " from " + utc_text(where.first) + " to " + utc_text(where.last);
  if (error.kind == ChunkError::Kind::newer)
    return {Error::Kind::newer_schema,
            what + " cannot be read: their chunk " + error.message + "; use a newer reident"};
  // What is imported waits for the shard, which is never written to.
  return {Error::Kind::corrupt,
          what + " cannot be read: their chunk " + error.message +
              "; 'reident verify' lists what else is damaged, " +
              (where.shard == 0 ? "a backup or 'reident import' brings them back"
                                : "a backup of the shard brings them back")};
}

void set_aside(sqlite::Connection& connection, const SampleRange& where,
               std::span<const std::uint8_t> bytes, const ChunkError& error) {
  if (error.kind == ChunkError::Kind::newer) throw damage(connection, where, error);
  connection
      .query(
          "INSERT INTO damaged_chunk (series, first_time, last_time, samples, bytes, reason, time) "
          "VALUES (?, ?, ?, ?, ?, ?, CAST(strftime('%s') AS INTEGER) * 1000000000)")
      .run(where.series, where.first, where.last, where.samples, bytes, error.message);
}

}  // namespace reident::storage
