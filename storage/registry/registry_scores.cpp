#include <algorithm>
#include <bit>
#include <cstring>

#include "storage/database/connection.hpp"
#include "storage/registry/registry.hpp"

namespace reident::storage {
namespace {

static_assert(std::endian::native == std::endian::little);

std::span<const std::uint8_t> blob(const std::vector<double>& values) {
  static constexpr std::uint8_t nothing = 0;  // a null pointer would be NULL
  if (values.empty()) return {&nothing, 0};
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(double)};
}

/// Throws Error (corrupt) unless a row is as it was recorded.
void require(bool is_sound) {
  if (!is_sound)
    throw Error(Error::Kind::corrupt,
                "a score of the registry is damaged: 'reident verify' names it; restore a backup");
}

std::vector<double> numbers(const sqlite::Query& row, int column) {
  const std::span<const std::uint8_t> bytes = row.bytes(column);
  require(bytes.size() % sizeof(double) == 0);
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::string block_sql(const std::string& rest) {
  return "SELECT begin_time, end_time, rows, believed, output_mean, output_square, input_low, "
         "input_high, baseline_square FROM block WHERE spacecraft = ? AND equipment = ? AND " +
         rest;
}

Block read_block(const sqlite::Query& row) {
  Block block{{row.integer(0), row.integer(1)},
              row.integer(2),
              row.real(3),
              numbers(row, 4),
              numbers(row, 5),
              numbers(row, 6),
              numbers(row, 7),
              numbers(row, 8)};
  require(block.output_square.size() == block.output_mean.size() &&
          block.input_high.size() == block.input_low.size());
  return block;
}

BlockScore read_score(std::int64_t version, const sqlite::Query& row) {
  BlockScore score{
      version,
      row.integer(0),
      row.integer(1),
      numbers(row, 2),
      numbers(row, 3),
      numbers(row, 4),
      {numbers(row, 5), row.is_null(6) ? std::nullopt : std::optional<std::int64_t>(row.integer(6)),
       numbers(row, 7), row.integer(8)},
      numbers(row, 9)};
  require(score.square.size() == score.mean.size() && score.noise.size() == score.mean.size());
  return score;
}

}  // namespace

void Registry::record_scores(const std::string& spacecraft, const std::string& equipment,
                             const std::optional<Block>& block,
                             const std::vector<BlockScore>& scores) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (block)
    db.query("INSERT INTO block VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .run(spacecraft, equipment, block->range.begin, block->range.end, block->rows,
             block->believed, blob(block->output_mean), blob(block->output_square),
             blob(block->input_low), blob(block->input_high), blob(block->baseline_square));
  for (const BlockScore& score : scores)
    db.query("INSERT INTO score VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .run(spacecraft, equipment, score.version, score.begin, score.rows, blob(score.mean),
             blob(score.square), blob(score.noise), blob(score.state.x), score.state.tick,
             blob(score.state.square_errors), score.state.rows, blob(score.bias_effects));
  transaction.commit();
}

std::vector<Block> Registry::blocks(const std::string& spacecraft, const std::string& equipment,
                                    Time since) const {
  std::vector<Block> blocks;
  sqlite::Query row = connection(database_).query(block_sql("begin_time >= ? ORDER BY begin_time"),
                                                  spacecraft, equipment, since);
  while (row.step()) blocks.push_back(read_block(row));
  return blocks;
}

std::vector<Block> Registry::newest_blocks(const EquipmentName& equipment,
                                           std::size_t count) const {
  std::vector<Block> blocks;
  sqlite::Query row = connection(database_).query(
      block_sql("TRUE ORDER BY begin_time DESC LIMIT ?"), equipment.spacecraft, equipment.equipment,
      static_cast<std::int64_t>(count));
  while (row.step()) blocks.push_back(read_block(row));
  std::reverse(blocks.begin(), blocks.end());
  return blocks;
}

std::optional<Time> Registry::last_block_end(const std::string& spacecraft,
                                             const std::string& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT end_time FROM block WHERE spacecraft = ? AND equipment = ? "
      "ORDER BY begin_time DESC LIMIT 1",
      spacecraft, equipment);
  return row.step() ? std::optional<Time>(row.integer(0)) : std::nullopt;
}

std::vector<BlockScore> Registry::scores(const std::string& spacecraft,
                                         const std::string& equipment, std::int64_t version,
                                         Time since) const {
  std::vector<BlockScore> scores;
  sqlite::Query row = connection(database_).query(
      "SELECT begin_time, rows, error_mean, error_square, noise_square, state, state_tick, "
      "run_square, run_rows, bias_effects "
      "FROM score WHERE spacecraft = ? AND equipment = ? AND version = ? AND begin_time >= ? "
      "ORDER BY begin_time",
      spacecraft, equipment, version, since);
  while (row.step()) scores.push_back(read_score(version, row));
  return scores;
}

}  // namespace reident::storage
