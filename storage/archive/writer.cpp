#include "storage/archive/writer.hpp"

#include <algorithm>

#include "storage/archive/damage.hpp"

namespace reident::storage {
namespace {

// Twice what comes would do; more ends a round sooner.
constexpr std::size_t step_for_each_sample = 4;

std::int64_t last_damage(sqlite::Connection& connection) {
  sqlite::Query row = connection.query("SELECT coalesce(max(id), 0) FROM damaged_chunk");
  row.step();
  return row.integer(0);
}

}  // namespace

Writer::Writer(sqlite::Connection& connection, const ArchiveOptions& options)
    : connection_(connection),
      options_(options),
      rollbacks_(connection.rollbacks()),
      damage_seen_(last_damage(connection)),
      recent_(connection),
      chunks_(connection),
      postponed_(connection),
      compaction_(recent_, chunks_, postponed_, options.chunk_samples) {}

void Writer::begin_round() {
  compaction_.begin();
  postponed_.try_again();
}

void Writer::compact_some(std::size_t samples_appended) {
  const bool is_due =
      recent_.samples() >= options_.recent_samples || recent_.batches() >= options_.recent_batches;
  if (!compaction_.is_under_way() && is_due) begin_round();
  const std::size_t step = std::max(options_.step_samples, step_for_each_sample * samples_appended);
  if (compaction_.is_under_way()) compaction_.step(step);
  while (recent_.samples() > 2 * options_.recent_samples) {
    if (!compaction_.is_under_way()) begin_round();
    compaction_.step(step);
  }
}

bool Writer::compact_all_step() {
  if (!compaction_.is_under_way()) {
    if (recent_.batches() == 0) return false;
    begin_round();
  }
  compaction_.step(options_.step_samples);
  return true;
}

std::vector<std::string> Writer::take_damages() {
  std::vector<std::string> damages;
  std::vector<std::pair<SampleRange, std::string>> found;
  {
    sqlite::Query row = connection_.query(
        "SELECT id, series, first_time, last_time, samples, reason FROM damaged_chunk "
        "WHERE id > ? ORDER BY id",
        damage_seen_);
    while (row.step()) {
      damage_seen_ = row.integer(0);
      found.push_back(
          {{row.integer(1), row.integer(2), row.integer(3), row.integer<std::size_t>(4)},
           row.text(5)});
    }
  }
  for (const auto& [where, reason] : found)
    damages.emplace_back(damage(connection_, where, {ChunkError::Kind::damaged, reason}).what());
  return damages;
}

}  // namespace reident::storage
