#include "tests/bench/identification/measure.hpp"

#include <chrono>
#include <fstream>
#include <malloc.h>
#include <stdexcept>
#include <string>

namespace reident::bench {
namespace {

/// A line of /proc/self/status, such as VmRSS [KiB].
double status_kib(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double value = 0; word == key + ":" && status >> value) return value;
  throw std::runtime_error("/proc/self/status has no " + key + "; the benchmark needs Linux");
}

/// The kernel starts its record of the peak anew.
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

}  // namespace

Measurement measure(int repeats, const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  malloc_trim(0);
  reset_peak();
  const double before = status_kib("VmRSS");
  work();
  Measurement result;
  result.peak_extra_mib = (status_kib("VmHWM") - before) / 1024;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = Clock::now();
    work();
    result.ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  return result;
}

}  // namespace reident::bench
