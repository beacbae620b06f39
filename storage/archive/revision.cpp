#include "storage/archive/revision.hpp"

#include <algorithm>

#include "storage/archive/damage.hpp"
#include "storage/chunks/overlay.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

using OptionalBytes = std::optional<std::span<const std::uint8_t>>;

// Times alone: a chunk whose other columns say nothing costs nothing for them.
std::vector<std::uint8_t> chunk_of_times(ChunkEncoder& encoder, const std::vector<Time>& times) {
  const std::vector<double> values(times.size());
  const std::vector<Quality> qualities(times.size());
  const std::vector<std::int64_t> sources(times.size());
  return encoder.encode({times, values, qualities, sources});
}

void remove(SampleColumns& samples, const std::vector<Time>& landed) {
  SampleColumns left;
  std::size_t next = 0;
  for (const Time time : landed) {
    const auto found = static_cast<std::size_t>(
        std::lower_bound(samples.time.begin() + static_cast<std::ptrdiff_t>(next),
                         samples.time.end(), time) -
        samples.time.begin());
    left.append(samples, next, found);
    next = found < samples.size() && samples.time[found] == time ? found + 1 : found;
  }
  left.append(samples, next, samples.size());
  samples = std::move(left);
}

}  // namespace

void keep_revision(sqlite::Connection& connection, ChunkEncoder& encoder, std::int64_t series,
                   std::int64_t batch, const Revision& revision) {
  const SampleColumns& replaced = revision.replaced;
  Time first = latest_time, last = earliest_time;
  std::vector<std::uint8_t> landed_bytes, replaced_bytes;
  for (const std::vector<Time>* times : {&revision.landed, &replaced.time}) {
    if (times->empty()) continue;
    first = std::min(first, times->front());
    last = std::max(last, times->back());
  }
  if (!revision.landed.empty()) landed_bytes = chunk_of_times(encoder, revision.landed);
  if (!replaced.empty()) replaced_bytes = encoder.encode(replaced.samples());
  const auto bytes_or_null = [](const std::vector<std::uint8_t>& bytes) {
    return bytes.empty() ? OptionalBytes() : OptionalBytes(bytes);
  };
  connection
      .query(
          "INSERT INTO revision (series, batch, first_time, last_time, landed, replaced) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      .run(series, batch, first, last, bytes_or_null(landed_bytes), bytes_or_null(replaced_bytes));
}

void undo_revisions(sqlite::Connection& connection, ChunkDecoder& decoder, std::int64_t series,
                    std::int64_t batch, TimeRange range, WantedColumns wanted,
                    SampleColumns& samples) {
  sqlite::Query row = connection.query(
      "SELECT first_time, last_time, landed, replaced FROM revision "
      "WHERE series = ? AND batch > ? ORDER BY batch DESC",
      series, batch);
  while (row.step()) {
    const auto decode = [&](int column, const ChunkTarget& target) {
      if (row.is_null(column)) return;
      if (const auto error = decoder.decode(row.bytes(column), range, target))
        throw damage(connection, {series, row.integer(0), row.integer(1), 0}, *error);
    };
    std::vector<Time> landed;
    decode(2, {.time = &landed});
    if (!landed.empty()) remove(samples, landed);
    SampleColumns replaced;
    decode(3, replaced.target(wanted));
    overlay(samples, {&replaced});
  }
}

}  // namespace reident::storage
