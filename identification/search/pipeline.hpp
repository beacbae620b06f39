// One identification of inputs that act without delay: its steps in their order (METHOD.md).
// Private to this folder. Nothing here throws but what the caller's functions throw.
#pragma once

#include <functional>

#include "identification/search/identify.hpp"

namespace reident::identification {

/// Does what identify() does, without what its options say of delays. Phases are "prepare",
/// "choose" and, for each model that is realised, "identify".
IdentifyResult run_pipeline(const Record& record, RowRange rows, const IdentifyOptions& options,
                            LagSums* kept);

/// What does as much: identify() itself, or a part of it.
using Identification = std::function<IdentifyResult(const Record&, RowRange rows,
                                                    const IdentifyOptions& options, LagSums* kept)>;

}  // namespace reident::identification
