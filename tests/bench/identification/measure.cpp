#include "tests/bench/identification/measure.hpp"

#include <fstream>
#include <malloc.h>
#include <stdexcept>
#include <string>

#include "service/support/allocator.hpp"

namespace reident::bench {
namespace {

/// A line of /proc/self/status, such as VmRSS [KiB].
double status_kib(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double value = 0; word == key + ":" && status >> value) return value;
  throw std::runtime_error("/proc/self/status has no " + key + "; the benchmark needs Linux");
}

/// The kernel starts its record of the peak again.
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

double clock_ms(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

}  // namespace

Measurement measure(int repeats, const std::function<void()>& work) {
  keep_freed_memory();  // as the service does; the untimed call below takes the pages
  malloc_trim(0);
  reset_peak();
  const double before = status_kib("VmRSS");
  work();
  Measurement result;
  result.peak_extra_mib = (status_kib("VmHWM") - before) / 1024;
  for (int i = 0; i < repeats; ++i) {
    const double wall = clock_ms(CLOCK_MONOTONIC), cpu = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
    work();
    result.cpu_ms.push_back(clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu);
    result.wall_ms.push_back(clock_ms(CLOCK_MONOTONIC) - wall);
  }
  return result;
}

}  // namespace reident::bench
