// Records that repeat each sample for several rows. Nothing here throws.
#pragma once

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Returns after how many rows each channel changes, the same number for all; 1 where they do not.
/// Some may change a few rows behind others. A record of held samples has so many times fewer rows
/// than it seems.
Index rows_per_sample(const Record& record);

}  // namespace reident::identification
