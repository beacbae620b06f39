#include "storage/care/source_removal.hpp"

#include "storage/archive/archive_access.hpp"
#include "storage/archive/holdings.hpp"
#include "storage/archive/series_ends.hpp"
#include "storage/database/connection.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

constexpr std::size_t chunks_of_transaction = 256;

std::optional<std::int64_t> source_id(sqlite::Connection& db, const std::string& spacecraft,
                                      Origin origin, const std::string& source) {
  sqlite::Query row =
      db.query("SELECT id FROM source WHERE spacecraft = ? AND origin = ? AND name = ?", spacecraft,
               static_cast<std::int64_t>(origin), source);
  return row.step() ? std::optional(row.integer(0)) : std::nullopt;
}

/// Takes the samples of a source out of a chunk; how many there were.
std::uint64_t clean(ChunkStore& chunks, const ChunkRow& row, std::int64_t source) {
  SampleColumns all, kept;
  chunks.take(row, all);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.source[i] != source) kept.append(all, i, i + 1);
  const std::uint64_t removed = all.size() - kept.size();
  if (removed == 0) return 0;
  if (kept.empty()) {
    chunks.discard(row);
  } else {
    const std::size_t end = kept.size();
    chunks.replace(row.series, {&row, 1}, kept, {&end, 1});
  }
  return removed;
}

/// Cleans the chunks of a series behind `at`, at most so many; false at the end.
bool clean_some(Archive& archive, std::int64_t id, std::int64_t source, std::optional<Time>& at,
                std::uint64_t& removed) {
  sqlite::Connection& db = connection(archive.database());
  sqlite::Transaction transaction(db);
  return archive_access(archive.database()).write(archive.options(), [&](Writer& writer) {
    writer.postponed().forget(source);
    SeriesHead& series = writer.recent().series(id);
    ChunkStore& chunks = writer.chunks();
    std::uint64_t here = 0;
    bool more = true;
    for (std::size_t looked = 0; looked < chunks_of_transaction && more; ++looked) {
      auto row = at ? chunks.after(id, *at) : chunks.at_or_before(id, earliest_time);
      if (!at && !row) row = chunks.after(id, earliest_time);
      more = row.has_value();
      if (!more) break;
      at = row->last;
      here += clean(chunks, *row, source);
    }
    if (here > 0) {
      series.samples -= std::min<std::uint64_t>(series.samples, here);
      find_ends(series, chunks);
      db.query("UPDATE series SET samples = ?, first_time = ?, last_time = ? WHERE id = ?")
          .run(series.samples, series.first, series.last, series.id);
    }
    transaction.commit();
    removed += here;
    return more;
  });
}

}  // namespace

SourceRemovalReport remove_source(Archive& archive, const std::string& spacecraft, Origin origin,
                                  const std::string& source) {
  SourceRemovalReport report;
  const auto id = source_id(connection(archive.database()), spacecraft, origin, source);
  if (!id) return report;
  for (const SeriesInfo& series : all_series(archive.database())) {
    if (series.spacecraft != spacecraft || series.origin != origin) continue;
    std::uint64_t removed = 0;
    for (std::optional<Time> at; clean_some(archive, series.id, *id, at, removed);) {
    }
    report.samples += removed;
    report.series += removed > 0 ? 1U : 0U;
  }
  return report;
}

std::vector<ImportedFile> imported_files(const Database& database) {
  std::vector<ImportedFile> files;
  sqlite::Query row =
      connection(database).query("SELECT id, file, request FROM import ORDER BY id");
  while (row.step()) files.push_back({row.integer(0), row.text(1), row.text(2)});
  return files;
}

void forget_import(Database& database, std::int64_t id) {
  connection(database).query("DELETE FROM import WHERE id = ?").run(id);
}

}  // namespace reident::storage
