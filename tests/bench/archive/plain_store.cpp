#include "tests/bench/archive/plain_store.hpp"

#include <algorithm>

namespace reident::bench {

PlainStore::PlainStore(const std::filesystem::path& file, Access access)
    : handle_(open_sqlite(file, access == Access::read
                                    ? SQLITE_OPEN_READONLY
                                    : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE)) {
  if (access == Access::write) {
    execute(handle_,
            "PRAGMA cache_size = -65536; PRAGMA journal_mode = WAL;"
            "PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 4096;"
            "PRAGMA journal_size_limit = 67108864;"
            "CREATE TABLE IF NOT EXISTS sample (parameter INTEGER, time INTEGER,"
            " value REAL, quality INTEGER, PRIMARY KEY (parameter, time)) WITHOUT ROWID");
    insert_ = prepare(handle_, "INSERT INTO sample VALUES (?, ?, ?, ?)");
  }
  range_ = prepare(handle_,
                   "SELECT time, value, quality FROM sample WHERE parameter = ? "
                   "AND time >= ? AND time < ? ORDER BY time");
}

void PlainStore::insert(const storage::Sample& sample, storage::Time time) {
  sqlite3_stmt* statement = insert_.get();
  sqlite3_bind_int64(statement, 1, sample.parameter);
  sqlite3_bind_int64(statement, 2, time);
  sqlite3_bind_double(statement, 3, sample.value);
  sqlite3_bind_int64(statement, 4, static_cast<std::int64_t>(sample.quality));
  check(handle_.get(), sqlite3_step(statement));
  sqlite3_reset(statement);
}

// Parameter by parameter: rows of one parameter lie side by side, and the next row then goes to a
// page that is at hand.
void PlainStore::append(std::span<const storage::TelemetryFrame> frames) {
  std::size_t most = 0;
  for (const auto& frame : frames) most = std::max(most, frame.samples.size());
  execute(handle_, "BEGIN IMMEDIATE");
  for (std::size_t i = 0; i < most; ++i)
    for (const auto& frame : frames)
      if (i < frame.samples.size()) insert(frame.samples[i], frame.generation_time);
  execute(handle_, "COMMIT");
}

void PlainStore::load(const MissionTelemetry& telemetry, std::uint64_t first, std::uint64_t count) {
  for (std::size_t i = 0; i < telemetry.parameters(); ++i) {
    execute(handle_, "BEGIN IMMEDIATE");
    for (std::uint64_t k = first; k < first + count; ++k)
      insert({static_cast<std::uint32_t>(i + 1), storage::Quality::good, telemetry.value(i, k)},
             MissionTelemetry::time(k));
    execute(handle_, "COMMIT");
  }
}

void PlainStore::read(std::uint32_t parameter, storage::TimeRange range,
                      storage::Series& series) const {
  sqlite3_stmt* statement = range_.get();
  sqlite3_bind_int64(statement, 1, parameter);
  sqlite3_bind_int64(statement, 2, range.begin);
  sqlite3_bind_int64(statement, 3, range.end);
  series.time.clear();
  series.value.clear();
  series.quality.clear();
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(statement)) == SQLITE_ROW) {
    series.time.push_back(sqlite3_column_int64(statement, 0));
    series.value.push_back(sqlite3_column_double(statement, 1));
    series.quality.push_back(static_cast<storage::Quality>(sqlite3_column_int(statement, 2)));
  }
  check(handle_.get(), code);
  sqlite3_reset(statement);
}

// The extent of the first parameter: all are sampled together.
std::optional<storage::TimeRange> PlainStore::extent() const {
  const auto end = [&](const std::string& which) {
    const SqliteStatement query =
        prepare(handle_, "SELECT " + which + "(time) FROM sample WHERE parameter = 1");
    check(handle_.get(), sqlite3_step(query.get()));
    return sqlite3_column_type(query.get(), 0) == SQLITE_NULL
               ? std::nullopt
               : std::optional(sqlite3_column_int64(query.get(), 0));
  };
  const auto first = end("min"), last = end("max");
  if (!first || !last) return std::nullopt;
  return storage::TimeRange{*first, *last + 1};
}

}  // namespace reident::bench
