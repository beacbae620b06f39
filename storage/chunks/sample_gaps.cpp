#include "storage/chunks/sample_gaps.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace reident::storage {
namespace {

using Difference = std::uint64_t;  // two times may be further apart than a Time can say

Difference difference(Time from, Time to) {
  return static_cast<Difference>(to) - static_cast<Difference>(from);
}

Time as_time(Difference value) {
  return static_cast<Time>(
      std::min(value, static_cast<Difference>(std::numeric_limits<Time>::max())));
}

/// The smallest element that is not below `percent` percent of all, which the call reorders.
Difference percentile(std::vector<Difference>& values, std::size_t percent) {
  const std::size_t rank = (values.size() * percent + 99) / 100 - 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// In order of time: see the head of sample_gaps.hpp.
bool is_regular(std::span<const Time> times, Difference step) {
  std::size_t near = 0, longer = 0, alone = 0;
  bool after_longer = false;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const Difference d = difference(times[i - 1], times[i]);
    const bool is_longer = d > step && d - step > step / 2;
    const bool is_near = !is_longer && d >= step - step / 2;
    near += is_near ? 1 : 0;
    longer += is_longer ? 1 : 0;
    alone += after_longer && is_near ? 1 : 0;
    after_longer = is_longer;
  }
  // The last difference has none after it.
  const std::size_t followed = longer - (after_longer ? 1 : 0);
  return 4 * near >= 3 * (times.size() - 1) && 2 * alone >= followed;
}

}  // namespace

Sampling SamplingMeter::measure(std::span<const Time> times) {
  if (times.size() < 2) return {};
  differences_.resize(times.size() - 1);
  for (std::size_t i = 1; i < times.size(); ++i)
    differences_[i - 1] = difference(times[i - 1], times[i]);
  const Difference step = percentile(differences_, 50);
  Difference above = 0, base = step;
  if (is_regular(times, step)) {
    const Difference jitter = step - percentile(differences_, 16);
    above = std::max(step / 2, 5 * std::min(jitter, step / 5));
  } else {
    base = percentile(differences_, 95);
    above = base / 2;
  }
  const Difference limit = base + std::min(above, std::numeric_limits<Difference>::max() - base);
  return {as_time(step), as_time(limit)};
}

void append_gaps(std::span<const Time> times, const Sampling& sampling,
                 std::vector<SampleGap>& gaps) {
  const auto limit = static_cast<Difference>(sampling.limit);
  for (std::size_t i = 1; i < times.size(); ++i)
    if (difference(times[i - 1], times[i]) > limit) gaps.push_back({times[i - 1], times[i]});
}

std::optional<SampleGap> gap_between(Time last, const Sampling& before, Time first,
                                     const Sampling& after) {
  const Time limit = std::max(before.limit, after.limit);
  if (limit == 0 || difference(last, first) <= static_cast<Difference>(limit)) return std::nullopt;
  return SampleGap{last, first};
}

}  // namespace reident::storage
