// Time and memory of a piece of work, measured alike for both programs of the comparison.
#pragma once

#include <functional>
#include <vector>

namespace reident::bench {

struct Measurement {
  std::vector<double> ms;     // wall time of each repeat
  double peak_extra_mib = 0;  // resident memory of the first call above what was resident before
};

/// Calls `work` once for its memory, untimed, which also warms the caches; then `repeats` times.
/// The memory is right only for the first call of this function in a process.
Measurement measure(int repeats, const std::function<void()>& work);

}  // namespace reident::bench
