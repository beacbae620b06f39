#include "storage/sql/archive_file.hpp"

#include <algorithm>
#include <limits>

#include "storage/chunks/fragment.hpp"
#include "storage/chunks/overlay.hpp"
#include "storage/database/schema.hpp"
#include "storage/types/time_ends.hpp"
#include "storage/types/utc_text.hpp"

namespace reident::storage::sql {
namespace {

// What temporary tables of the same names hold is not the archive: the tables of main are asked.
constexpr std::string_view series_columns = R"sql(
SELECT series.id, series.spacecraft,
       coalesce(parameter.name, CAST(series.parameter AS TEXT)), series.origin, series.moved
FROM main.series LEFT JOIN main.parameter ON parameter.spacecraft = series.spacecraft
                                         AND parameter.id = series.parameter
)sql";

// A name's ids come from the index of names; a number may be the id of a parameter without a name.
constexpr std::string_view of_one_name = R"sql(
WHERE series.spacecraft = ?1 AND series.origin IN (0, 1)
  AND series.parameter IN (SELECT id FROM main.parameter WHERE spacecraft = ?1 AND name = ?2
                           UNION ALL SELECT CAST(?2 AS INTEGER))
ORDER BY series.id
)sql";

constexpr std::string_view chunk_columns =
    "SELECT first_time, last_time, samples, least, greatest, shard, data FROM main.chunk "
    "WHERE series = ?1 AND first_time ";

std::string archive_name(sqlite3* connection) {
  const char* file = sqlite3_db_filename(connection, "main");
  return file == nullptr || *file == '\0' ? std::string("a database in memory") : file;
}

/// A half-open range that ends at the latest time includes it: it may hold one sample more.
TimeRange range_of(TimeBounds bounds) {
  return {bounds.first, just_after(bounds.last)};
}

bool meet(TimeBounds a, TimeBounds b) {
  return a.first <= b.last && b.first <= a.last;
}

void drop_behind(Time last, const ChunkTarget& target, std::size_t before) {
  if (target.time->size() == before || target.time->back() <= last) return;
  target.time->pop_back();
  if (target.value != nullptr) target.value->pop_back();
  if (target.quality != nullptr) target.quality->pop_back();
  if (target.source != nullptr) target.source->pop_back();
}

}  // namespace

std::string_view NamePool::keep(std::string_view text) {
  const auto place = texts_.find(text);
  return place != texts_.end() ? *place : *texts_.emplace(text).first;
}

ArchiveFile::ArchiveFile(sqlite3* connection, NamePool& names)
    : connection_(connection), names_(names), shards_(connection) {
  refuse_others();
}

void ArchiveFile::refuse_others() {
  const auto pragma = [this](const char* text) {
    Statement statement(connection_, text);
    return statement.step() ? statement.integer(0) : 0;
  };
  const std::string file = archive_name(connection_);
  if (pragma("PRAGMA main.application_id") != schema::application_id)
    throw QueryError(SQLITE_ERROR, "telemetry: " + file +
                                       " is not a reident archive: open the archive itself, not "
                                       "as an attached database");
  const std::int64_t version = pragma("PRAGMA main.user_version");
  if (version == schema::version) return;
  const std::string what = "telemetry: " + file + " has schema version " + std::to_string(version) +
                           " and this extension reads " + std::to_string(schema::version) + ": ";
  throw QueryError(SQLITE_ERROR,
                   what + (version > schema::version
                               ? "load the extension of the reident that writes the file"
                               : "start this version's reidentd on the file once, which brings it "
                                 "up to date"));
}

Statement& ArchiveFile::prepared(std::unique_ptr<Statement>& statement, std::string_view text) {
  if (!statement) statement = std::make_unique<Statement>(connection_, text);
  return *statement;
}

void ArchiveFile::add_series(Statement& rows, const Selection& selection,
                             std::vector<SeriesName>& found) {
  while (rows.step()) {
    const auto origin = static_cast<Origin>(rows.integer(3));
    if (!selection.spacecraft.has(rows.text(1)) || !selection.parameter.has(rows.text(2)) ||
        !selection.origin.has(name(origin)))
      continue;
    found.push_back({rows.integer(0), names_.keep(rows.text(1)), names_.keep(rows.text(2)), origin,
                     rows.integer(4)});
  }
}

std::vector<SeriesName> ArchiveFile::find(const Selection& selection) {
  std::vector<SeriesName> found;
  if (selection.spacecraft.all() || selection.parameter.all()) {
    Statement& rows =
        prepared(all_series_, std::string(series_columns).append("ORDER BY series.id"));
    add_series(rows.bind(), selection, found);
    return found;
  }
  Statement& rows = prepared(named_series_, std::string(series_columns).append(of_one_name));
  for (const std::string& spacecraft : selection.spacecraft.texts())
    for (const std::string& parameter : selection.parameter.texts()) {
      // A series that has the number as its id and another name is another's to find.
      Selection one = selection;
      one.parameter.intersect({parameter});
      add_series(rows.bind(std::string_view(spacecraft), std::string_view(parameter)), one, found);
    }
  return found;
}

std::optional<ChunkEntry> ArchiveFile::one_chunk(Statement& rows) {
  if (!rows.step()) return std::nullopt;
  ChunkEntry chunk{.first_time = rows.integer(0),
                   .last_time = rows.integer(1),
                   .samples = static_cast<std::uint64_t>(rows.integer(2)),
                   .least = std::numeric_limits<double>::infinity(),
                   .greatest = -std::numeric_limits<double>::infinity(),
                   .shard = rows.integer(5),
                   .data = rows.integer(6)};
  if (!rows.is_null(3) && !rows.is_null(4)) {
    chunk.least = rows.real(3);
    chunk.greatest = rows.real(4);
  }
  rows.reset();
  return chunk;
}

std::optional<ChunkEntry> ArchiveFile::chunk_from(std::int64_t series, Time time) {
  Statement& before = prepared(
      chunk_before_, std::string(chunk_columns).append("<= ?2 ORDER BY first_time DESC LIMIT 1"));
  const std::optional<ChunkEntry> chunk = one_chunk(before.bind(series, time));
  if (chunk && chunk->last_time >= time) return chunk;
  Statement& after =
      prepared(chunk_after_, std::string(chunk_columns).append("> ?2 ORDER BY first_time LIMIT 1"));
  return one_chunk(after.bind(series, time));
}

std::optional<ChunkEntry> ArchiveFile::chunk_to(std::int64_t series, Time time) {
  Statement& before = prepared(
      chunk_before_, std::string(chunk_columns).append("<= ?2 ORDER BY first_time DESC LIMIT 1"));
  return one_chunk(before.bind(series, time));
}

void ArchiveFile::decode(const SeriesName& series, const ChunkEntry& chunk, TimeBounds bounds,
                         const ChunkTarget& target) {
  Statement& rows = chunk.shard == 0
                        ? prepared(bytes_, "SELECT bytes FROM main.chunk_data WHERE id = ?1")
                        : shards_.bytes_of(chunk.shard);
  const std::span<const std::uint8_t> bytes =
      rows.bind(chunk.data).step() ? rows.blob(0) : std::span<const std::uint8_t>();
  const TimeBounds of{chunk.first_time, chunk.last_time};
  const auto summary = read_summary(bytes);
  if (const auto* error = std::get_if<ChunkError>(&summary)) fail_damaged(series, of, *error);
  const auto& inside = std::get<ChunkSummary>(summary);
  if (inside.first_time != of.first || inside.last_time != of.last || inside.count != chunk.samples)
    fail_damaged(series, of, {ChunkError::Kind::damaged, "holds other samples than its row says"});

  const std::size_t before = target.time->size();
  if (const auto error = decoder_.decode(bytes, range_of(bounds), target))
    fail_damaged(series, of, *error);
  drop_behind(bounds.last, target, before);
  rows.reset();
}

// A series' fragments stay the same for as long as the user's statement runs.
const std::vector<ArchiveFile::Fragment>& ArchiveFile::fragments(const SeriesName& series) {
  const auto [place, is_new] = fragments_.try_emplace(series.id);
  if (!is_new) return place->second;
  Statement& batches =
      prepared(batches_,
               "SELECT (SELECT min(batch) FROM main.recent), (SELECT max(batch) FROM main.recent)");
  if (!batches.bind().step() || batches.is_null(0)) return place->second;
  const std::int64_t last = batches.integer(1);
  if (last <= series.moved) return place->second;
  const std::int64_t begin = std::max(batches.integer(0), series.moved + 1);
  if (schema::are_too_many_batches(begin, last)) {
    const std::string file = archive_name(connection_);
    throw QueryError(SQLITE_CORRUPT_VTAB, "telemetry: " + file + " has recent samples of batches " +
                                              std::to_string(begin) + " to " +
                                              std::to_string(last) +
                                              ", more than there can be; 'reident verify " + file +
                                              "' lists what is damaged");
  }
  Statement& fragment = prepared(
      fragment_, "SELECT first_time, last_time FROM main.recent WHERE batch = ?1 AND series = ?2");
  for (std::int64_t batch = begin; batch <= last; ++batch)
    if (fragment.bind(batch, series.id).step())
      place->second.push_back({batch, {fragment.integer(0), fragment.integer(1)}});
  return place->second;
}

std::optional<TimeBounds> ArchiveFile::next_fragment(const SeriesName& series, TimeBounds bounds,
                                                     bool descending) {
  std::optional<TimeBounds> next;
  for (const Fragment& fragment : fragments(series)) {
    if (!meet(fragment.time, bounds)) continue;
    if (!next || (descending ? fragment.time.last > next->last : fragment.time.first < next->first))
      next = fragment.time;
  }
  return next;
}

void ArchiveFile::lay_recent_over(SampleColumns& base, const SeriesName& series, TimeBounds bounds,
                                  WantedColumns wanted) {
  std::vector<SampleColumns> found;
  Statement& rows =
      prepared(fragment_bytes_, "SELECT data FROM main.recent WHERE batch = ?1 AND series = ?2");
  for (const Fragment& fragment : fragments(series)) {
    if (!meet(fragment.time, bounds)) continue;
    const std::span<const std::uint8_t> bytes = rows.bind(fragment.batch, series.id).step()
                                                    ? rows.blob(0)
                                                    : std::span<const std::uint8_t>();
    const ChunkTarget target = found.emplace_back().target(wanted);
    if (const auto error = decode_fragment(bytes, range_of(bounds), target))
      fail_damaged(series, fragment.time, *error);
    drop_behind(bounds.last, target, 0);
  }
  rows.reset();
  std::vector<const SampleColumns*> newer;
  for (const SampleColumns& fragment : found) newer.push_back(&fragment);
  overlay(base, newer);
}

std::string_view ArchiveFile::source_name(std::int64_t id) {
  const auto [place, is_new] = sources_.try_emplace(id);
  if (is_new) {
    Statement& rows = prepared(source_, "SELECT name FROM main.source WHERE id = ?1");
    if (rows.bind(id).step()) place->second = names_.keep(rows.text(0));
    rows.reset();
  }
  return place->second;
}

void ArchiveFile::fail_damaged(const SeriesName& series, TimeBounds of,
                               const ChunkError& error) const {
  const std::string file = archive_name(connection_);
  const std::string what = "telemetry: the samples of " + std::string(series.parameter) + " of " +
                           std::string(series.spacecraft) + " (" +
                           std::string(name(series.origin)) + ") from " + utc_text(of.first) +
                           " to " + utc_text(of.last) + " in " + file +
                           " cannot be read: their chunk " + error.message;
  if (error.kind == ChunkError::Kind::newer)
    throw QueryError(SQLITE_ERROR, what + "; load the extension of a newer reident");
  throw QueryError(SQLITE_CORRUPT_VTAB,
                   what + "; 'reident verify " + file + "' lists what else is damaged");
}

}  // namespace reident::storage::sql
