#include "storage/archive/holdings.hpp"

#include <algorithm>

#include "storage/archive/archive_access.hpp"
#include "storage/archive/sequence.hpp"
#include "storage/database/connection.hpp"

namespace reident::storage {

std::vector<SeriesInfo> all_series(const Database& database) {
  std::vector<SeriesInfo> all;
  sqlite::Query row = database.impl().connection->query(
      "SELECT series.id, series.spacecraft, origin, series.parameter, "
      "coalesce(name, CAST(series.parameter AS TEXT)) AS shown, samples, first_time, last_time "
      "FROM series LEFT JOIN parameter ON parameter.spacecraft = series.spacecraft "
      "AND parameter.id = series.parameter WHERE samples > 0 "
      "ORDER BY series.spacecraft, origin, shown, series.parameter");
  while (row.step())
    all.push_back({.id = row.integer(0),
                   .spacecraft = row.text(1),
                   .origin = row.integer<Origin>(2),
                   .parameter = row.integer<std::uint32_t>(3),
                   .name = row.text(4),
                   .samples = row.integer<std::uint64_t>(5),
                   .first = row.integer(6),
                   .last = row.integer(7)});
  return all;
}

std::optional<std::int64_t> series_id(const Database& database, const std::string& spacecraft,
                                      Origin origin, std::uint32_t parameter) {
  return archive_access(database).reader().find(spacecraft, origin, parameter);
}

void each_sequence_gap(const Database& database, const std::optional<GapKey>& beyond,
                       const std::function<bool(const GapKey&, SequenceGap&&)>& visit) {
  const GapKey after = beyond.value_or(GapKey{});  // ids of sources begin at 1
  sqlite::Query row = database.impl().connection->query(
      "SELECT source, run, first, last, time_before, time_after, spacecraft, name, origin "
      "FROM sequence_gap JOIN source ON source.id = sequence_gap.source "
      "WHERE (source, run, first) > (?, ?, ?) ORDER BY source, run, first",
      after.source, after.run, after.first);
  while (row.step()) {
    const GapKey key{row.integer(0), row.integer(1), row.integer(2)};
    if (!visit(key, {.spacecraft = row.text(6),
                     .source = row.text(7),
                     .origin = row.integer<Origin>(8),
                     .first = from_column(key.first),
                     .last = from_column(row.integer(3)),
                     .before = row.integer(4),
                     .after = row.integer(5)}))
      return;
  }
}

std::size_t damaged_chunks(const Database& database) {
  sqlite::Query row = database.impl().connection->query("SELECT count(*) FROM damaged_chunk");
  row.step();
  return row.integer<std::size_t>(0);
}

std::map<std::int64_t, std::string> source_names(const Database& database) {
  std::map<std::int64_t, std::string> names;
  sqlite::Query row = database.impl().connection->query("SELECT id, name FROM source");
  while (row.step()) names.emplace(row.integer(0), row.text(1));
  return names;
}

std::vector<ChunkOutline> chunk_outlines(const Database& database, std::int64_t series,
                                         TimeRange range) {
  return archive_access(database).reader().outlines(series, range);
}

bool read_chunk(const Database& database, const ChunkOutline& chunk, WantedColumns wanted,
                SampleColumns& samples) {
  return archive_access(database).reader().read(chunk, wanted, samples);
}

SeriesBatches::SeriesBatches(const Database& database, std::int64_t series, TimeRange range,
                             std::size_t chunks, WantedColumns wanted)
    : database_(&database), series_(series), range_(range), chunks_(chunks), wanted_(wanted) {}

bool SeriesBatches::next(SampleColumns& batch) {
  batch = {};
  while (!at_end_ && batch.empty()) {
    Time end = range_.end;
    {
      sqlite::Query row = database_->impl().connection->query(
          "SELECT first_time FROM chunk WHERE series = ? AND first_time > ? ORDER BY first_time "
          "LIMIT 1 OFFSET ?",
          series_, range_.begin, chunks_ - 1);
      if (row.step()) {
        if (row.integer(0) <= range_.begin)
          database_->impl().connection->fail_out_of_order("chunk");
        end = std::min(end, row.integer(0));
      }
    }
    batch = archive_access(*database_).reader().read(series_, {range_.begin, end}, wanted_);
    at_end_ = end == range_.end;
    range_.begin = end;
  }
  return !batch.empty();
}

}  // namespace reident::storage
