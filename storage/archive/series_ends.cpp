#include "storage/archive/series_ends.hpp"

#include <algorithm>

#include "storage/types/time_ends.hpp"

namespace reident::storage {

void find_ends(SeriesHead& series, ChunkStore& chunks) {
  series.first.reset();
  series.last.reset();
  const auto include = [&series](Time first, Time last) {
    series.first = std::min(series.first.value_or(first), first);
    series.last = std::max(series.last.value_or(last), last);
  };
  if (const auto newest = chunks.at_or_before(series.id, latest_time)) {
    auto oldest = chunks.at_or_before(series.id, earliest_time);
    if (!oldest) oldest = chunks.after(series.id, earliest_time);
    include(oldest->first, newest->last);
  }
  for (const SeriesHead::Fragment& fragment : series.fragments)
    include(fragment.samples.time.front(), fragment.samples.time.back());
}

}  // namespace reident::storage
