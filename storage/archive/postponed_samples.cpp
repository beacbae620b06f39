#include "storage/archive/postponed_samples.hpp"

#include <bit>
#include <utility>

namespace reident::storage {

namespace {

bool is_there(sqlite::Connection& connection) {
  return connection.query("SELECT 1 FROM sqlite_master WHERE name = 'postponed_sample'").step();
}

}  // namespace

std::uint64_t settled_and_postponed(sqlite::Connection& connection, std::int64_t series) {
  if (!is_there(connection)) return 0;
  sqlite::Query row = connection.query(
      "SELECT count(*) FROM postponed_sample WHERE series = ? AND settled", series);
  row.step();
  return row.integer<std::uint64_t>(0);
}

PostponedSamples::PostponedSamples(sqlite::Connection& connection)
    : connection_(connection), has_table_(is_there(connection)) {
  try_again();
}

// A value is kept as its bits: SQLite has no NaN.
void PostponedSamples::add(const PostponedSample& one, const ShardError& why) {
  if (!has_table_)
    connection_.execute(
        "CREATE TABLE postponed_sample (id INTEGER PRIMARY KEY AUTOINCREMENT, "
        "series INTEGER NOT NULL REFERENCES series, time INTEGER NOT NULL, "
        "value_bits INTEGER NOT NULL, quality INTEGER NOT NULL, "
        "source INTEGER NOT NULL REFERENCES source, numbered INTEGER NOT NULL, "
        "settled INTEGER NOT NULL)");
  has_table_ = true;
  connection_
      .query(
          "INSERT INTO postponed_sample (series, time, value_bits, quality, source, numbered, "
          "settled) VALUES (?, ?, ?, ?, ?, ?, ?)")
      .run(one.series, one.time, std::bit_cast<std::int64_t>(one.sample.value),
           static_cast<std::int64_t>(one.sample.quality), one.sample.source, one.is_numbered,
           one.is_settled);
  reason_ = why.what();
  ++added_;
}

void PostponedSamples::try_again() {
  if (!has_table_) return;
  sqlite::Query row = connection_.query("SELECT coalesce(max(id), 0) FROM postponed_sample");
  row.step();
  due_ = row.integer(0);
}

void PostponedSamples::take(std::size_t most,
                            const std::function<void(std::vector<PostponedSample>&&)>& store) {
  std::vector<PostponedSample> taken;
  std::int64_t last = 0;
  {
    sqlite::Query row = connection_.query(
        "SELECT id, series, time, value_bits, quality, source, numbered, settled "
        "FROM postponed_sample WHERE id <= ? ORDER BY id LIMIT ?",
        due_, most);
    while (row.step()) {
      last = row.integer(0);
      taken.push_back({.series = row.integer(1),
                       .time = row.integer(2),
                       .sample = {std::bit_cast<double>(row.integer(3)), row.integer<Quality>(4),
                                  row.integer(5)},
                       .is_numbered = row.integer(6) != 0,
                       .is_settled = row.integer(7) != 0});
    }
  }
  connection_.query("DELETE FROM postponed_sample WHERE id <= ?").run(last);
  if (taken.size() < most || last == due_) due_ = 0;
  const std::uint64_t added_before = added_;
  store(std::move(taken));
  if (added_ != added_before) due_ = 0;
}

void PostponedSamples::forget(std::int64_t source) {
  if (has_table_) connection_.query("DELETE FROM postponed_sample WHERE source = ?").run(source);
}

bool PostponedSamples::are_waiting() {
  return has_table_ && connection_.query("SELECT 1 FROM postponed_sample LIMIT 1").step();
}

std::string PostponedSamples::reason() {
  if (!reason_.empty() && !are_waiting()) reason_.clear();
  return reason_;
}

}  // namespace reident::storage
