// Time and memory of a piece of work, measured alike for both programs of the comparison.
#pragma once

#include <functional>
#include <vector>

namespace reident::bench {

struct Measurement {
  /// For each repeat the processor time of all threads, which other load on the machine does not
  /// change, and the wall time. With one thread on an idle machine they are the same.
  std::vector<double> cpu_ms, wall_ms;
  double peak_extra_mib = 0;  // resident memory of the first call above what was resident before
};

/// Calls `work` once for its memory, untimed, which also warms the caches; then `repeats` times.
/// The memory is right only for the first call of this function in a process.
Measurement measure(int repeats, const std::function<void()>& work);

}  // namespace reident::bench
