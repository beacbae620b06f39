// Many samples of one series in few figures, for whoever draws or prints a long range.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "service/history/readers.hpp"

namespace reident::history {

/// The samples of one bin. Extremes are of the values that are not NaN, each with the time at which
/// it came first.
struct BinSummary {
  storage::TimeRange bin;
  storage::Time first = 0, last = 0;  // of its samples
  std::uint64_t samples = 0;
  std::uint64_t numbers = 0;  // samples that are not NaN; 0: there are no extremes
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  storage::Time least_time = 0, greatest_time = 0;
  storage::Quality worst = storage::Quality::good;
};

struct SeriesSummary {
  std::vector<BinSummary> bins;  // ascending; those with samples alone
  /// Times between two neighbouring samples where others are missing, as far as they are not
  /// shorter than a bin: ascending.
  std::vector<storage::TimeRange> gaps;
};

/// Reads the samples of a series in the range of `bins` once, whatever their number. `go_on` is
/// called between batches of samples, and may throw.
SeriesSummary summarise(const TelemetryReader& telemetry, const storage::SeriesInfo& series,
                        const storage::TimeBins& bins, const std::function<void()>& go_on = {});

}  // namespace reident::history
