#include "service/windows/chunk_cache.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "service/support/floor_divide.hpp"

namespace reident {

using identification::Record;
using identification::TickRange;

Record ChunkCache::read_and_keep(TickRange ticks, const Read& read) {
  Record record = read(ticks);
  for (std::int64_t chunk = -floor_divide(-ticks.begin, chunk_ticks);
       (chunk + 1) * chunk_ticks <= ticks.end; ++chunk)
    chunks_[chunk] = rows_at(record, {chunk * chunk_ticks, (chunk + 1) * chunk_ticks});
  return record;
}

Record ChunkCache::over(TickRange ticks, const Read& read) {
  const std::int64_t first_chunk = floor_divide(ticks.begin, chunk_ticks);
  chunks_.erase(chunks_.begin(), chunks_.lower_bound(first_chunk));
  const auto end_of_chunk_at = [](std::int64_t at) {
    return (floor_divide(at, chunk_ticks) + 1) * chunk_ticks;
  };
  const auto is_kept = [&](std::int64_t at) {
    return end_of_chunk_at(at) <= ticks.end && chunks_.contains(floor_divide(at, chunk_ticks));
  };
  std::vector<TickRange> missing;
  for (std::int64_t tick = ticks.begin; tick < ticks.end;) {
    const std::int64_t next = std::min(ticks.end, end_of_chunk_at(tick));
    if (!is_kept(tick)) {
      if (!missing.empty() && missing.back().end == tick)
        missing.back().end = next;
      else
        missing.push_back({tick, next});
    }
    tick = next;
  }
  std::map<std::int64_t, Record> fresh;  // by first tick: what was read now
  for (const TickRange& range : missing) fresh[range.begin] = read_and_keep(range, read);

  std::optional<Record> first;  // of a chunk that begins before
  std::vector<const Record*> parts;
  auto range = missing.begin();
  for (std::int64_t tick = ticks.begin; tick < ticks.end;) {
    if (range != missing.end() && range->begin == tick) {
      parts.push_back(&fresh.at(tick));
      tick = range++->end;
      continue;
    }
    const Record& chunk = chunks_.at(floor_divide(tick, chunk_ticks));
    const std::int64_t end = end_of_chunk_at(tick);
    if (end - tick < chunk_ticks)
      parts.push_back(&first.emplace(rows_at(chunk, {tick, end})));
    else
      parts.push_back(&chunk);
    tick = end;
  }
  return parts.empty() ? read({ticks.begin, ticks.begin}) : joined(parts);
}

void ChunkCache::forget(TickRange ticks) {
  std::erase_if(chunks_, [&ticks](const auto& chunk) {
    return chunk.first * chunk_ticks < ticks.end && ticks.begin < (chunk.first + 1) * chunk_ticks;
  });
}

}  // namespace reident
