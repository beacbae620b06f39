// Samples that no sum of squares can hold: those that are not finite, or too large to be squared
// (METHOD.md, section 1). The sums are looked at first, which costs nothing; the samples only where
// these are spoilt. Private to this folder. Nothing here throws.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/identify.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::identification {

/// Whether the sums hold no such sample. Requires sums of all channels.
bool all_finite(const RangeSums& sums);

/// Returns the verdict non_finite for the first such sample in the rows, by channel and row, with
/// the names of the options; absent where there is none.
std::optional<Verdict> non_finite_values(const Record& record, RowRange rows,
                                         const IdentifyOptions& options);

}  // namespace reident::identification
