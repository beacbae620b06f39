// Outputs that drift by themselves (METHOD.md, section 7, "Drift"). Private to this folder. Nothing
// here throws but what the caller's functions throw.
#pragma once

#include <functional>

#include "identification/search/identify.hpp"

namespace reident::identification {

/// Identifies from rows of the record, which has the channels that the options are about.
using IdentificationOf = std::function<IdentifyResult(const Record&, RowRange rows, LagSums* kept)>;

/// Returns the model that `identify_from` gives. Where no input drives slow modes and most of its
/// errors are slower than the rows are long, returns that of the rows without what is so slow in
/// inputs and outputs, unless that errs more on the record.
IdentifyResult identify_despite_drift(const Record& record, RowRange rows,
                                      const IdentifyOptions& options, LagSums* kept,
                                      const IdentificationOf& identify_from);

}  // namespace reident::identification
