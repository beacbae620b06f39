#include "storage/care/retention.hpp"

#include <algorithm>
#include <set>

#include "storage/archive/archive_access.hpp"
#include "storage/archive/series_ends.hpp"
#include "storage/care/chunk_walk.hpp"
#include "storage/care/split.hpp"
#include "storage/database/connection.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

using Cause = ChunkWalk::Cause;

std::uint64_t bytes_in_use(sqlite::Connection& connection) {
  const auto pragma = [&connection](const char* name) {
    sqlite::Query row = connection.query(std::string("PRAGMA ") + name);
    return row.step() ? row.integer<std::uint64_t>(0) : 0;
  };
  const std::uint64_t pages = pragma("page_count") - pragma("freelist_count");
  // A shard counts by the share of it that is still read.
  sqlite::Query row =
      connection.query("SELECT coalesce(sum(bytes / all_chunks * chunks), 0) FROM shard");
  row.step();
  return pages * pragma("page_size") + row.integer<std::uint64_t>(0);
}

void count(RetentionReport& report, const ChunkWalk::Step& step) {
  ++report.chunks;
  report.samples += step.row.samples;
  report.bytes += step.bytes;
  report.first = std::min(report.first.value_or(step.row.first), step.row.first);
  report.last = std::max(report.last.value_or(step.row.last), step.row.last);
}

bool holds_recent(const SeriesHead& series, const ChunkRow& row) {
  return std::any_of(series.fragments.begin(), series.fragments.end(),
                     [&row](const SeriesHead::Fragment& fragment) {
                       const auto& time = fragment.samples.time;
                       const auto at = std::lower_bound(time.begin(), time.end(), row.first);
                       return at != time.end() && *at <= row.last;
                     });
}

/// One row for each range in which nothing was left; what was removed before and is next to it is
/// of that range.
void add_removal(sqlite::Connection& connection, ChunkStore& chunks, const ChunkWalk::Step& removed,
                 Time now) {
  const char* name = removed.cause == Cause::age ? "age" : "size";
  const std::int64_t series = removed.row.series;
  const Time end = just_after(removed.row.last);
  std::int64_t id = 0;
  {
    sqlite::Query row = connection.query(
        "SELECT id, begin_time, end_time FROM removal WHERE series = ? AND cause = ? "
        "ORDER BY id DESC LIMIT 1",
        series, name);
    if (row.step()) {
      const Time lower = std::min(row.integer(2), end);
      const Time upper = std::max(row.integer(1), removed.row.first);
      const auto between = chunks.at_or_before(series, upper);
      if (!between || between->last < lower) id = row.integer(0);
    }
  }
  if (id != 0)
    connection
        .query(
            "UPDATE removal SET begin_time = min(begin_time, ?), end_time = max(end_time, ?), "
            "samples = samples + ?, time = ? WHERE id = ?")
        .run(removed.row.first, end, removed.row.samples, now, id);
  else
    connection
        .query(
            "INSERT INTO removal (series, begin_time, end_time, samples, cause, time) "
            "VALUES (?, ?, ?, ?, ?, ?)")
        .run(series, removed.row.first, end, removed.row.samples, name, now);
}

}  // namespace

RetentionReport plan_retention(Database& database, const RetentionRule& rule,
                               const std::vector<ProtectedRange>& protection, Time now) {
  sqlite::Connection& db = connection(database);
  const sqlite::ReadTransaction snapshot(db);
  RetentionReport report;
  report.bytes_in_use = bytes_in_use(db);
  const auto excess = [&] {
    return rule.max_bytes && report.bytes_in_use > *rule.max_bytes + report.bytes;
  };
  ChunkWalk walk(db, rule, protection, now);
  walk.visit(excess, [&](const ChunkWalk::Step& step) {
    count(report, step);
    return true;
  });
  report.protected_chunks = walk.passed();
  report.too_large = excess();
  report.bytes_in_use -= std::min(report.bytes, report.bytes_in_use);
  return report;
}

Retention::Retention(Archive& archive, const RetentionRule& rule,
                     const std::vector<ProtectedRange>& protection, Time now)
    : archive_(archive),
      rule_(rule),
      now_(now),
      walk_(std::make_unique<ChunkWalk>(connection(archive.database()), rule, protection, now)) {
  remove_empty_shards(archive);
}

Retention::~Retention() = default;

void Retention::protect(const std::vector<ProtectedRange>& protection) {
  walk_->protect(protection);
}

bool Retention::step() {
  sqlite::Connection& db = connection(archive_.database());
  RetentionReport done = report_;
  sqlite::Transaction transaction(db);
  return archive_access(archive_.database()).write(archive_.options(), [&](Writer& writer) {
    const std::uint64_t in_use = bytes_in_use(db);
    std::size_t chunks = 0;
    std::uint64_t bytes = 0;
    const auto excess = [&] { return rule_.max_bytes && in_use > *rule_.max_bytes + bytes; };
    std::set<std::int64_t> touched;
    walk_->visit(excess, [&](const ChunkWalk::Step& step) {
      if (chunks == chunks_of_step) return false;
      SeriesHead& series = writer.recent().series(step.row.series);
      // Compaction is about to rewrite it: it goes another time.
      if (holds_recent(series, step.row)) return true;
      writer.chunks().discard(step.row);
      series.samples -= std::min<std::uint64_t>(series.samples, step.row.samples);
      add_removal(db, writer.chunks(), step, now_);
      touched.insert(series.id);
      count(done, step);
      ++chunks;
      bytes += step.bytes;
      return true;
    });
    for (const std::int64_t id : touched) {
      SeriesHead& series = writer.recent().series(id);
      find_ends(series, writer.chunks());
      db.query("UPDATE series SET samples = ?, first_time = ?, last_time = ? WHERE id = ?")
          .run(series.samples, series.first, series.last, series.id);
      // What changed late in time of which nothing is left serves nobody.
      db.query("DELETE FROM revision WHERE series = ? AND last_time < ?")
          .run(series.id, series.first.value_or(latest_time));
    }
    done.bytes_in_use = bytes_in_use(db);
    done.protected_chunks = walk_->passed();
    done.too_large = rule_.max_bytes && done.bytes_in_use > *rule_.max_bytes && chunks == 0;
    transaction.commit();
    report_ = done;
    return chunks > 0;
  });
}

}  // namespace reident::storage
