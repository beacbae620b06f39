// One identification of inputs that act without delay.
#pragma once

#include "identification/search/identify.hpp"

namespace reident::identification {

/// identify() without what its options say of delays.
IdentifyResult run_pipeline(const Record& record, RowRange rows, const IdentifyOptions& options,
                            LagSums* kept);

}  // namespace reident::identification
