#include "service/daemon/kept_chunks.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "service/support/floor_divide.hpp"

namespace reident {

using identification::Record;
using identification::TickRange;

Record KeptChunks::read_and_keep(TickRange ticks, const Read& read) {
  Record record = read(ticks);
  for (std::int64_t chunk = -floor_divide(-ticks.begin, chunk_ticks);
       (chunk + 1) * chunk_ticks <= ticks.end; ++chunk)
    chunks_[chunk] = rows_at(record, {chunk * chunk_ticks, (chunk + 1) * chunk_ticks});
  return record;
}

Record KeptChunks::over(TickRange ticks, const Read& read) {
  const std::int64_t first_chunk = floor_divide(ticks.begin, chunk_ticks);
  chunks_.erase(chunks_.begin(), chunks_.lower_bound(first_chunk));
  const auto kept_at = [this, &ticks](std::int64_t at) {
    return at % chunk_ticks == 0 && at + chunk_ticks <= ticks.end &&
           chunks_.contains(floor_divide(at, chunk_ticks));
  };
  std::vector<TickRange> missing;
  for (std::int64_t tick = ticks.begin; tick < ticks.end;) {
    const std::int64_t next =
        std::min(ticks.end, (floor_divide(tick, chunk_ticks) + 1) * chunk_ticks);
    if (!kept_at(tick)) {
      if (!missing.empty() && missing.back().end == tick)
        missing.back().end = next;
      else
        missing.push_back({tick, next});
    }
    tick = next;
  }
  std::map<std::int64_t, Record> fresh;  // by first tick: what was read now
  for (const TickRange& stretch : missing) fresh[stretch.begin] = read_and_keep(stretch, read);

  std::vector<const Record*> parts;
  auto stretch = missing.begin();
  for (std::int64_t tick = ticks.begin; tick < ticks.end;) {
    if (stretch != missing.end() && stretch->begin == tick) {
      parts.push_back(&fresh.at(tick));
      tick = stretch++->end;
    } else {
      parts.push_back(&chunks_.at(floor_divide(tick, chunk_ticks)));
      tick += chunk_ticks;
    }
  }
  return parts.empty() ? read({ticks.begin, ticks.begin}) : joined(parts);
}

void KeptChunks::forget(TickRange ticks) {
  std::erase_if(chunks_, [&ticks](const auto& chunk) {
    return chunk.first * chunk_ticks < ticks.end && ticks.begin < (chunk.first + 1) * chunk_ticks;
  });
}

}  // namespace reident
