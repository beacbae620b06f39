#include "storage/archive/series_reader.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "storage/archive/damage.hpp"
#include "storage/archive/revision.hpp"
#include "storage/chunks/fragment.hpp"
#include "storage/chunks/overlay.hpp"
#include "storage/database/schema.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

// Chunks do not overlap: the one that `begin` may lie in is the last that starts no later.
constexpr std::string_view chunks_in_range =
    "SELECT first_time, last_time, samples, shard, data FROM chunk "
    "WHERE series = ?1 AND first_time <= ?3 AND last_time >= ?2 AND first_time >= "
    "coalesce((SELECT max(first_time) FROM chunk WHERE series = ?1 AND first_time <= ?2), ?2) "
    "ORDER BY first_time";

constexpr std::string_view chunks_within =
    "SELECT first_time, last_time, samples, step, gap_limit, shard, data FROM chunk "
    "WHERE series = ? AND first_time BETWEEN ? AND ?3 AND last_time <= ?3 ORDER BY first_time";

/// The checksum of a chunk's summary, which has one of the rest (CHUNK.md); 0 where there are too
/// few bytes.
std::uint64_t identity_of(std::span<const std::uint8_t> chunk) {
  constexpr std::size_t length = 8, begin = ChunkSummary::bytes - length;
  std::uint64_t identity = 0;
  if (chunk.size() < begin + length) return identity;
  for (const std::uint8_t byte : chunk.subspan(begin, length)) identity = identity << 8 | byte;
  return identity;
}

SampleRange range_of(std::int64_t series, const sqlite::Query& row) {
  return {series, row.integer(0), row.integer(1), row.integer<std::size_t>(2)};
}

// In [first, last], at the rate of this chunk: so that vectors are made once, not grown by copying.
// What a damaged chunk says may be anything.
std::size_t samples_expected(const SampleRange& chunk, Time first, Time last) {
  constexpr double most = 1 << 22;
  const double rate = static_cast<double>(chunk.samples) /
                      (static_cast<double>(chunk.last) - static_cast<double>(chunk.first) + 1);
  const double expected = rate * (static_cast<double>(last) - static_cast<double>(first));
  return expected > 0 ? static_cast<std::size_t>(std::min(expected * 1.01 + 16, most)) : 0;
}

}  // namespace

std::optional<std::int64_t> SeriesReader::find(std::string_view spacecraft, Origin origin,
                                               std::uint32_t parameter) {
  sqlite::Query row = connection_.query(
      "SELECT id FROM series WHERE spacecraft = ? AND origin = ? AND parameter = ?", spacecraft,
      origin, parameter);
  return row.step() ? std::optional(row.integer(0)) : std::nullopt;
}

SeriesReader::Extent SeriesReader::extent_of(std::int64_t batch, std::int64_t series) {
  const auto [extent, is_new] = extents_.try_emplace({batch, series});
  if (is_new) {
    sqlite::Query row = connection_.query(
        "SELECT first_time, last_time FROM recent WHERE batch = ? AND series = ?", batch, series);
    if (row.step()) extent->second = {row.integer(0), row.integer(1)};
  }
  return extent->second;
}

template <typename Use>
void SeriesReader::each_recent(std::int64_t series, Time first, Time last, const Use& use) {
  std::int64_t from = 0, to = 0;
  {
    sqlite::Query batches = connection_.query(
        // SQLite looks up one of min() and max() in the index, and scans the table for both.
        "SELECT (SELECT min(batch) FROM recent), (SELECT max(batch) FROM recent), "
        "(SELECT moved FROM series WHERE id = ?) + 1",
        series);
    if (!batches.step() || batches.is_null(1)) return;
    extents_.erase(extents_.begin(), extents_.lower_bound({batches.integer(0), 0}));
    from = std::max(batches.integer(0), batches.integer(2));
    to = batches.integer(1);
  }
  if (schema::are_too_many_batches(from, to))
    throw Error(
        Error::Kind::corrupt,
        "database " + connection_.path() + " has recent samples of batches " +
            std::to_string(from) + " to " + std::to_string(to) +
            ", more than there can be: restore a backup, or see what 'reident verify' says");
  sqlite::Query row = connection_.query(
      "SELECT first_time, last_time, samples, data FROM recent WHERE batch = ? AND series = ?");
  for (std::int64_t batch = from; batch <= to; ++batch) {
    const Extent extent = extent_of(batch, series);
    if (extent.first <= last && extent.last >= first && row.bind(batch, series).step()) use(row);
  }
}

std::vector<SeriesReader::Extent> SeriesReader::recent(std::int64_t series) {
  std::vector<Extent> found;
  each_recent(series, earliest_time, latest_time, [&found](const sqlite::Query& row) {
    found.push_back({row.integer(0), row.integer(1)});
  });
  return found;
}

SampleColumns SeriesReader::read(std::int64_t series, TimeRange range, WantedColumns wanted,
                                 std::optional<std::int64_t> as_of) {
  SampleColumns samples;
  if (range.begin >= range.end && range.end != latest_time) return samples;
  const Time last = last_of(range);
  sqlite::ReadTransaction snapshot(connection_);
  {
    sqlite::Query row = connection_.query(chunks_in_range, series, range.begin, last);
    while (row.step()) {
      const SampleRange chunk = range_of(series, row);
      if (samples.empty()) samples.reserve(samples_expected(chunk, range.begin, last), wanted);
      const auto bytes = bytes_.read({row.integer(3), row.integer(4)});
      if (const auto error = decoder_.decode(bytes, range, samples.target(wanted)))
        throw damage(connection_, chunk, *error);
    }
  }
  std::vector<SampleColumns> recent;
  each_recent(series, range.begin, last, [&](const sqlite::Query& row) {
    recent.emplace_back();
    if (const auto error = decode_fragment(row.bytes(3), range, recent.back().target(wanted)))
      throw damage(connection_, range_of(series, row), *error);
  });
  std::vector<const SampleColumns*> newer;
  for (const SampleColumns& fragment : recent) newer.push_back(&fragment);
  overlay(samples, newer);
  if (as_of) undo_revisions(connection_, decoder_, series, *as_of, range, wanted, samples);
  return samples;
}

std::vector<ChunkOutline> SeriesReader::outlines(std::int64_t series, TimeRange range) {
  std::vector<ChunkOutline> found;
  if (range.begin >= range.end) return found;
  const Time last = range.end - 1;
  sqlite::ReadTransaction snapshot(connection_);
  std::vector<std::pair<Time, Time>> recent;
  each_recent(series, range.begin, last, [&recent](const sqlite::Query& row) {
    recent.emplace_back(row.integer(0), row.integer(1));
  });
  const auto lies_in = [&recent](Time from, Time to) {
    return std::any_of(recent.begin(), recent.end(), [from, to](const auto& fragment) {
      return fragment.first <= to && fragment.second >= from;
    });
  };
  sqlite::Query row = connection_.query(chunks_within, series, range.begin, last);
  bool follows = false;
  for (Time before = range.begin; row.step(); before = row.integer(1)) {
    const Time chunk_first = row.integer(0), chunk_last = row.integer(1);
    follows = follows && !lies_in(before, chunk_first);
    const bool is_whole = !lies_in(chunk_first, chunk_last);
    if (is_whole)
      found.push_back({.first = chunk_first,
                       .last = chunk_last,
                       .samples = row.integer<std::size_t>(2),
                       .sampling = {row.integer(3), row.integer(4)},
                       .identity = identity_of(bytes_.read({row.integer(5), row.integer(6)})),
                       .follows = follows,
                       .series = series,
                       .shard = row.integer(5),
                       .data = row.integer(6)});
    follows = is_whole;
  }
  return found;
}

bool SeriesReader::read(const ChunkOutline& chunk, WantedColumns wanted, SampleColumns& samples) {
  samples = {};
  const std::span<const std::uint8_t> bytes = bytes_.read({chunk.shard, chunk.data});
  if (bytes.empty() || identity_of(bytes) != chunk.identity) return false;
  if (const auto error = decoder_.decode(bytes, samples.target(wanted)))
    throw damage(connection_, {chunk.series, chunk.first, chunk.last, chunk.samples, chunk.shard},
                 *error);
  return true;
}

std::optional<Time> SeriesReader::first_at_or_after(std::int64_t series, Time time) {
  sqlite::ReadTransaction snapshot(connection_);
  std::optional<Time> found;
  const auto look_into = [&](TimeRange range) {
    const SampleColumns samples = read(series, range, {false, false, false});
    if (!samples.empty()) found = samples.time.front();
  };
  {
    sqlite::Query row = connection_.query(
        "SELECT min(first_time) FROM chunk WHERE series = ? AND first_time >= ?", series, time);
    if (row.step() && !row.is_null(0)) found = row.integer(0);
  }
  each_recent(series, time, latest_time, [&](const sqlite::Query& row) {
    if (row.integer(0) >= time) found = std::min(found.value_or(latest_time), row.integer(0));
  });
  // What straddles `time` may hold an earlier one than those that start behind it.
  look_into({time, just_after(found.value_or(latest_time))});
  return found;
}

std::optional<Time> SeriesReader::last_at_or_before(std::int64_t series, Time time) {
  sqlite::ReadTransaction snapshot(connection_);
  std::optional<Time> found;
  {
    sqlite::Query row = connection_.query(
        "SELECT first_time, last_time FROM chunk WHERE series = ? AND first_time <= ? "
        "ORDER BY first_time DESC LIMIT 1",
        series, time);
    if (row.step()) found = row.integer(1) <= time ? row.integer(1) : row.integer(0);
  }
  each_recent(series, earliest_time, time, [&](const sqlite::Query& row) {
    const Time known = row.integer(1) <= time ? row.integer(1) : row.integer(0);
    found = std::max(found.value_or(earliest_time), known);
  });
  if (!found) return std::nullopt;
  const SampleColumns samples = read(series, {*found, just_after(time)}, {false, false, false});
  if (samples.empty())
    throw damage(connection_, {series, *found, time, 0},
                 {ChunkError::Kind::damaged, "holds other samples than its row says"});
  return samples.time.back();
}

}  // namespace reident::storage
