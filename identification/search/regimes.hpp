// Inputs of operating regimes, which a model uses only where they help (METHOD.md, section 7,
// "Operating regimes"). Private to the library. Nothing here throws but what the caller's functions
// throw.
#pragma once

#include "identification/search/pipeline.hpp"

namespace reident::identification {

/// Returns the model of all inputs where it errs at least 5 % less on held-out rows than the one
/// without the last `options.regime_inputs`, and else that one, in which these have no effect.
/// Requires more inputs than these. `kept` as identify() has it.
IdentifyResult identify_with_regimes(const Record& record, RowRange rows,
                                     const IdentifyOptions& options, LagSums* kept,
                                     const Identification& identify_from);

}  // namespace reident::identification
