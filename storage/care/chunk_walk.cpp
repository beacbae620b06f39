#include "storage/care/chunk_walk.hpp"

#include <algorithm>
#include <map>

#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

/// The time before which samples are too old, of each spacecraft.
std::map<std::string, Time> cutoffs(sqlite::Connection& connection, Time keep, Time now) {
  std::map<std::string, Time> result;
  sqlite::Query row = connection.query(
      "SELECT spacecraft, max(last_time) FROM series WHERE last_time IS NOT NULL "
      "GROUP BY spacecraft");
  while (row.step()) {
    const Time newest = std::min(row.integer(1), now);
    result[row.text(0)] = earlier(newest, keep);
  }
  return result;
}

void add(std::vector<TimeRange>& ranges, TimeRange range) {
  const auto touches = [&range](const TimeRange& other) {
    return other.begin <= range.end && range.begin <= other.end;
  };
  const auto first = std::find_if(ranges.begin(), ranges.end(), [&](const TimeRange& other) {
    return touches(other) || other.begin > range.end;
  });
  auto last = first;
  for (; last != ranges.end() && touches(*last); ++last) {
    range.begin = std::min(range.begin, last->begin);
    range.end = std::max(range.end, last->end);
  }
  ranges.insert(ranges.erase(first, last), range);
}

}  // namespace

ChunkWalk::ChunkWalk(sqlite::Connection& connection, const RetentionRule& rule,
                     const std::vector<ProtectedRange>& protection, Time now)
    : connection_(connection) {
  std::map<std::string, Time> old;
  if (rule.keep) old = cutoffs(connection, *rule.keep, now);
  {
    sqlite::Query row = connection.query(
        "SELECT id, spacecraft, parameter FROM series WHERE first_time IS NOT NULL");
    while (row.step()) {
      Place place{row.integer(0), row.text(1), row.integer<std::uint32_t>(2), {}, earliest_time};
      if (const auto found = old.find(place.spacecraft); found != old.end())
        place.cutoff = found->second;
      places_.push_back(std::move(place));
    }
  }
  protect(protection);
}

void ChunkWalk::protect(const std::vector<ProtectedRange>& protection) {
  for (Place& place : places_)
    for (const ProtectedRange& one : protection)
      if (one.spacecraft == place.spacecraft &&
          (!one.parameter || *one.parameter == place.parameter))
        add(place.kept, one.range);
}

bool ChunkWalk::is_kept(const Place& place, const ChunkRow& row) const {
  const auto found =
      std::partition_point(place.kept.begin(), place.kept.end(), [&row](const TimeRange& range) {
        return range.end <= row.first && range.end != latest_time;
      });
  return found != place.kept.end() && found->begin <= row.last;
}

void ChunkWalk::pass(Place& place) {
  const Time first = place.next->row.first;
  place.from = first == latest_time ? std::nullopt : std::optional(first + 1);
  place.next.reset();
}

/// The next chunk of the series that may go.
void ChunkWalk::find_next(Place& place) {
  while (place.from) {
    {
      sqlite::Query row = connection_.query(
          "SELECT chunk.first_time, chunk.last_time, samples, step, gap_limit, chunk.shard, data, "
          "coalesce(length(chunk_data.bytes), shard.bytes / all_chunks, 0) FROM chunk "
          "LEFT JOIN chunk_data ON chunk.shard = 0 AND chunk_data.id = data "
          "LEFT JOIN shard ON shard.id = chunk.shard "
          "WHERE series = ? AND chunk.first_time >= ? ORDER BY chunk.first_time LIMIT 1",
          place.series, *place.from);
      if (!row.step()) return;
      if (row.integer(0) < *place.from) connection_.fail_out_of_order("chunk");
      place.next = Step{{place.series,
                         row.integer(0),
                         row.integer(1),
                         row.integer<std::size_t>(2),
                         {row.integer(3), row.integer(4)},
                         {row.integer(5), row.integer(6)}},
                        row.integer<std::uint64_t>(7),
                        place.cutoff && row.integer(1) < *place.cutoff ? Cause::age : Cause::size};
    }
    if (place.next->cause == Cause::size && !by_size_) return place.next.reset();
    if (!is_kept(place, place.next->row)) return;
    ++passed_;
    pass(place);
  }
}

void ChunkWalk::visit(const std::function<bool()>& excess,
                      const std::function<bool(const Step&)>& visit) {
  // What is too old goes first, whatever the room; then it may turn out that there is enough.
  for (const bool by_size : {false, true}) {
    by_size_ = by_size;
    if (by_size && !excess()) return;
    for (Place& place : places_) {
      place.next.reset();  // others may have written since
      find_next(place);
    }
    while (true) {
      Place* oldest = nullptr;
      for (Place& place : places_)
        if (place.next && (oldest == nullptr || place.next->row.last < oldest->next->row.last))
          oldest = &place;
      if (oldest == nullptr) break;
      if (by_size && !excess()) return;
      if (!visit(*oldest->next)) return;
      pass(*oldest);
      find_next(*oldest);
    }
  }
}

}  // namespace reident::storage
