#include "service/windows/chunk_cache.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "service/support/floor_divide.hpp"

namespace reident {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::Segment;
using identification::TickRange;

namespace {

/// Rows that were read now, or those of a chunk from a tick on.
struct Part {
  const Record* fresh;
  const PackedRows* kept;
  std::int64_t from_tick;

  Index rows() const { return fresh ? fresh->rows() : kept->rows_from(from_tick); }
};

Record joined(const std::vector<Part>& parts) {
  Index rows = 0;
  for (const Part& part : parts) rows += part.rows();
  const auto& [fresh, kept, from_tick] = parts.front();
  Record result =
      kept ? kept->blank(rows)
           : Record{
                 fresh->period_s, Matrix(rows, fresh->u.cols()), Matrix(rows, fresh->y.cols()), {}};
  Index at = 0;
  for (const Part& part : parts) {
    if (part.kept) {
      part.kept->unpack(part.from_tick, result, at);
    } else {
      result.u.middleRows(at, part.rows()) = part.fresh->u;
      result.y.middleRows(at, part.rows()) = part.fresh->y;
      for (const Segment& one : part.fresh->segments)
        add_segment(result.segments, {at + one.begin, at + one.end, one.first_tick});
    }
    at += part.rows();
  }
  return result;
}

}  // namespace

Record ChunkCache::read_and_keep(TickRange ticks, const Read& read) {
  Record record = read(ticks);
  for (std::int64_t chunk = -floor_divide(-ticks.begin, chunk_ticks);
       (chunk + 1) * chunk_ticks <= ticks.end; ++chunk)
    chunks_.insert_or_assign(chunk,
                             PackedRows(record, {chunk * chunk_ticks, (chunk + 1) * chunk_ticks}));
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

  std::vector<Part> parts;
  auto range = missing.begin();
  for (std::int64_t tick = ticks.begin; tick < ticks.end;) {
    if (range != missing.end() && range->begin == tick) {
      parts.push_back({&fresh.at(tick), nullptr, tick});
      tick = range++->end;
    } else {
      parts.push_back({nullptr, &chunks_.at(floor_divide(tick, chunk_ticks)), tick});
      tick = end_of_chunk_at(tick);
    }
  }
  if (parts.size() == 1 && parts.front().fresh) return std::move(fresh.begin()->second);
  return parts.empty() ? read({ticks.begin, ticks.begin}) : joined(parts);
}

void ChunkCache::forget(TickRange ticks) {
  std::erase_if(chunks_, [&ticks](const auto& chunk) {
    return chunk.first * chunk_ticks < ticks.end && ticks.begin < (chunk.first + 1) * chunk_ticks;
  });
}

}  // namespace reident
