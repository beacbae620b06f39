// Records that repeat each sample for several rows. Nothing here throws.
#pragma once

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Returns after how many rows the channels change, all in the same rows; 1 where they do not. A
/// record of held samples has so many times fewer rows than it seems.
Index rows_per_sample(const Record& record);

}  // namespace reident::identification
