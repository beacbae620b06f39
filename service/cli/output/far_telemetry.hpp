// Telemetry that lies far from the rest, as that of a clock that was read wrongly does.
#pragma once

#include <string>
#include <vector>

#include "storage/types/time_bins.hpp"

namespace reident::cli {

/// A stretch of bins that is at least a year from the stretch with the most samples.
struct FarTelemetry {
  storage::TimeRange range;
  std::uint64_t samples = 0;
};

/// Finds them in the samples that came in each bin. Ascending in time.
std::vector<FarTelemetry> far_telemetry(const storage::TimeBins& bins,
                                        const std::vector<std::uint64_t>& came);

/// "72 samples from ... to ... lie years from the rest: was the clock of their file read rightly?"
std::string sentence(const FarTelemetry& far);

}  // namespace reident::cli
