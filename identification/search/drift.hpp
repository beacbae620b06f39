// Outputs that drift by themselves (METHOD.md, section 7, "Drift"). Private to this folder. Nothing
// here throws but what the caller's functions throw.
#pragma once

#include "identification/search/pipeline.hpp"

namespace reident::identification {

/// Returns what `identify_from` gives. Where the model's errors are slow, takes the model of inputs
/// and outputs without what is so slow, if that leaves less which the errors' past does not
/// foretell and does not lose as much on rows held out. Not with an order that is given.
IdentifyResult identify_despite_drift(const Record& record, RowRange rows,
                                      const IdentifyOptions& options, LagSums* kept,
                                      const Identification& identify_from);

}  // namespace reident::identification
