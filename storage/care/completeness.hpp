// How many samples came, and how many are missing, in each range of time.
//
// Missing samples are those that would stand in the gaps of a series (sample_gaps.hpp), one for
// each step of the chunks at the gap: the larger step of the two. A gap counts in the bin in
// which it begins, its missing samples in the bins in which they would stand. A series is expected
// from its first sample on.
//
// Counts come from the rows of the chunks; times are decoded where a chunk crosses a bin's border,
// and where recent samples lie over it.
#pragma once

#include <vector>

#include "storage/archive/holdings.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::storage {

/// Counts of the series' samples in each bin. Where its last sample is followed by none up to
/// `until`, that is a gap too, if it is long enough for one. Throws Error (corrupt) where samples
/// cannot be decoded.
std::vector<BinCounts> completeness(const Database& database, const SeriesInfo& series,
                                    const TimeBins& bins, Time until);

/// The gaps of the series that meet `range`, each between the samples beside it, ascending; the
/// last one, up to `until`, is there as completeness() counts it. Throws Error (corrupt) likewise.
std::vector<TimeRange> gaps(const Database& database, const SeriesInfo& series, TimeRange range,
                            Time until);

}  // namespace reident::storage
