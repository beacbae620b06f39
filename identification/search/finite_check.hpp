// Samples that no sum of squares can hold.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/identify.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::identification {

/// A sample that is not finite, or too large to be squared, spoils the sums that it is in.
bool all_finite(const StretchSums& sums);

/// The first such sample in the rows, by channel and row.
std::optional<Verdict> non_finite_values(const Record& record, RowRange rows,
                                         const IdentifyOptions& options);

}  // namespace reident::identification
