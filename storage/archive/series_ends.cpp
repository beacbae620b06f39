#include "storage/archive/series_ends.hpp"

#include <algorithm>
#include <limits>

namespace reident::storage {

void find_ends(SeriesHead& series, ChunkStore& chunks) {
  constexpr Time earliest = std::numeric_limits<Time>::min();
  constexpr Time latest = std::numeric_limits<Time>::max();
  series.first.reset();
  series.last.reset();
  const auto include = [&series](Time first, Time last) {
    series.first = std::min(series.first.value_or(first), first);
    series.last = std::max(series.last.value_or(last), last);
  };
  if (const auto newest = chunks.at_or_before(series.id, latest)) {
    auto oldest = chunks.at_or_before(series.id, earliest);
    if (!oldest) oldest = chunks.after(series.id, earliest);
    include(oldest->first, newest->last);
  }
  for (const SeriesHead::Fragment& fragment : series.fragments)
    include(fragment.samples.time.front(), fragment.samples.time.back());
}

}  // namespace reident::storage
