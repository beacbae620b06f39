#include "storage/archive/chunk_store.hpp"

#include <algorithm>

#include "storage/archive/damage.hpp"

namespace reident::storage {
namespace {

std::optional<double> finite_bound(const ChunkSummary& summary, double bound) {
  return summary.least > summary.greatest ? std::nullopt : std::optional(bound);
}

}  // namespace

std::optional<ChunkRow> ChunkStore::one(std::string_view condition, std::int64_t series,
                                        Time time) {
  sqlite::Query row = connection_.query(
      "SELECT first_time, last_time, samples, step, gap_limit, shard, data FROM chunk "
      "WHERE series = ? AND first_time " +
          std::string(condition) + " LIMIT 1",
      series, time);
  if (!row.step()) return std::nullopt;
  return ChunkRow{.series = series,
                  .first = row.integer(0),
                  .last = row.integer(1),
                  .samples = row.integer<std::size_t>(2),
                  .sampling = {row.integer(3), row.integer(4)},
                  .place = {row.integer(5), row.integer(6)}};
}

std::optional<ChunkRow> ChunkStore::at_or_before(std::int64_t series, Time time) {
  return one("<= ? ORDER BY first_time DESC", series, time);
}

std::optional<ChunkRow> ChunkStore::before(std::int64_t series, Time time) {
  return one("< ? ORDER BY first_time DESC", series, time);
}

std::optional<ChunkRow> ChunkStore::after(std::int64_t series, Time time) {
  return one("> ? ORDER BY first_time", series, time);
}

// Chunks do not overlap: a time between the first and the last of one is in no other.
bool ChunkStore::has_decoded(std::int64_t series, Time time) const {
  return looked_into_ && decoded_series_ == series && decoded_.time.front() <= time &&
         time <= decoded_.time.back();
}

std::optional<Held> ChunkStore::find(std::int64_t series, Time time) {
  if (!has_decoded(series, time)) {
    const std::optional<ChunkRow> row = at_or_before(series, time);
    if (!row || row->last < time) return std::nullopt;
    looked_into_.reset();
    decoded_ = {};
    take(*row, decoded_);
    if (decoded_.empty()) return std::nullopt;
    looked_into_ = row->place;
    decoded_series_ = series;
  }
  const auto found = std::lower_bound(decoded_.time.begin(), decoded_.time.end(), time);
  if (found == decoded_.time.end() || *found != time) return std::nullopt;
  const auto at = static_cast<std::size_t>(found - decoded_.time.begin());
  return Held{decoded_.value[at], decoded_.quality[at], decoded_.source[at]};
}

void ChunkStore::take(const ChunkRow& row, SampleColumns& samples) {
  const std::span<const std::uint8_t> bytes = bytes_.read(row.place);
  const std::size_t before = samples.size();
  std::optional<ChunkError> error = decoder_.decode(bytes, samples.target());
  if (!error && (samples.size() - before != row.samples || samples.time[before] != row.first ||
                 samples.time.back() != row.last))
    error = {ChunkError::Kind::damaged, "holds other samples than its row says"};
  if (!error) return;
  samples.cut(before);
  // Whoever puts the shard right has it back; here it is damaged for ever.
  if (row.place.shard != 0 && error->kind == ChunkError::Kind::damaged)
    throw bytes_.unreadable(
        row.place.shard,
        damage(connection_, {row.series, row.first, row.last, row.samples, row.place.shard}, *error)
            .what());
  set_aside(connection_, {row.series, row.first, row.last, row.samples}, bytes, *error);
  remove(row);
}

void ChunkStore::remove(const ChunkRow& row) {
  connection_.query("DELETE FROM chunk WHERE series = ? AND first_time = ?")
      .run(row.series, row.first);
  remove_bytes(row.place);
}

// Shards never change: what nobody refers to any more goes with the last chunk of its shard.
void ChunkStore::remove_bytes(ChunkPlace place) {
  if (looked_into_ == place) looked_into_.reset();
  if (place.shard == 0)
    connection_.query("DELETE FROM chunk_data WHERE id = ?").run(place.data);
  else
    connection_.query("UPDATE shard SET chunks = chunks - 1 WHERE id = ?").run(place.shard);
}

void ChunkStore::move(const ChunkRow& row, ChunkPlace to) {
  connection_.query("UPDATE chunk SET shard = ?, data = ? WHERE series = ? AND first_time = ?")
      .run(to.shard, to.data, row.series, row.first);
  connection_.query("UPDATE shard SET chunks = chunks + 1 WHERE id = ?").run(to.shard);
  remove_bytes(row.place);
}

Sampling ChunkStore::insert(std::int64_t series, const SampleColumns& samples, std::size_t begin,
                            std::size_t end) {
  const auto part = [begin, end](const auto& column) {
    return std::span(column).subspan(begin, end - begin);
  };
  const std::vector<std::uint8_t> bytes = encoder_.encode(
      {part(samples.time), part(samples.value), part(samples.quality), part(samples.source)});
  const ChunkSummary summary = std::get<ChunkSummary>(read_summary(bytes));
  const Sampling sampling = meter_.measure(part(samples.time));
  connection_.query("INSERT INTO chunk_data (bytes) VALUES (?)")
      .run(std::span<const std::uint8_t>(bytes));
  connection_
      .query(
          "INSERT INTO chunk (series, first_time, last_time, samples, step, gap_limit, least, "
          "greatest, data) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .run(series, summary.first_time, summary.last_time, summary.count, sampling.step,
           sampling.limit, finite_bound(summary, summary.least),
           finite_bound(summary, summary.greatest), connection_.last_id());
  return sampling;
}

void ChunkStore::replace(std::int64_t series, std::span<const ChunkRow> old,
                         const SampleColumns& samples, std::span<const std::size_t> piece_ends) {
  for (const ChunkRow& row : old) remove(row);
  const std::optional<ChunkRow> previous = before(series, samples.time.front());
  const std::optional<ChunkRow> next = after(series, samples.time.back());
  std::vector<SampleGap> gaps;
  const auto add_border = [&gaps](Time last, const Sampling& before, Time first,
                                  const Sampling& after) {
    if (const auto gap = gap_between(last, before, first, after)) gaps.push_back(*gap);
  };
  std::size_t begin = 0;
  Sampling sampling_before = previous ? previous->sampling : Sampling{};
  for (const std::size_t end : piece_ends) {
    const Sampling sampling = insert(series, samples, begin, end);
    if (begin > 0)
      add_border(samples.time[begin - 1], sampling_before, samples.time[begin], sampling);
    else if (previous)
      add_border(previous->last, sampling_before, samples.time[0], sampling);
    append_gaps(std::span(samples.time).subspan(begin, end - begin), sampling, gaps);
    sampling_before = sampling;
    begin = end;
  }
  if (next) add_border(samples.time.back(), sampling_before, next->first, next->sampling);
  connection_.query("DELETE FROM sample_gap WHERE series = ? AND begin_time BETWEEN ? AND ?")
      .run(series, previous ? previous->last : samples.time.front(), samples.time.back());
  sqlite::Query insert_gap =
      connection_.query("INSERT INTO sample_gap (series, begin_time, end_time) VALUES (?, ?, ?)");
  for (const SampleGap& gap : gaps) insert_gap.run(series, gap.begin, gap.end);
}

void ChunkStore::discard(const ChunkRow& row) {
  remove(row);
  const std::optional<ChunkRow> previous = before(row.series, row.first);
  const std::optional<ChunkRow> next = after(row.series, row.first);
  connection_.query("DELETE FROM sample_gap WHERE series = ? AND begin_time BETWEEN ? AND ?")
      .run(row.series, previous ? previous->last : row.first, row.last);
  if (!previous || !next) return;
  if (const auto gap = gap_between(previous->last, previous->sampling, next->first, next->sampling))
    connection_.query("INSERT INTO sample_gap (series, begin_time, end_time) VALUES (?, ?, ?)")
        .run(row.series, gap->begin, gap->end);
}

}  // namespace reident::storage
