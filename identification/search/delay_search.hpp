// Which delays of the inputs the rows show (METHOD.md, section 6, "Delays"). Private to this
// folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/search/identify.hpp"

namespace reident::identification {

/// Returns delays in rows, one for each input and each at most `most` and a third of the longest
/// segment, with which few states explain the outputs as well as those of the model `without`
/// delays do; all zero where the rows do not say so. Without a model: with which few states explain
/// the outputs best. Spends a sixth of the search budget for each of its two steps.
std::vector<int> delays_shown(const Record& record, RowRange rows, int most,
                              const Identified* without, const IdentifyOptions& options);

}  // namespace reident::identification
