#include "storage/chunks/overlay.hpp"

#include <algorithm>
#include <cstdint>

namespace reident::storage {
namespace {

struct Place {
  Time time;
  std::uint32_t run;
  std::uint32_t at;
};

bool follow_each_other(const SampleColumns& base, const std::vector<const SampleColumns*>& newer) {
  const SampleColumns* last = &base;
  for (const SampleColumns* run : newer) {
    if (run->empty()) continue;
    if (!last->empty() && last->time.back() >= run->time.front()) return false;
    last = run;
  }
  return true;
}

/// All samples of the runs in order of time, the one that stays at each time alone.
std::vector<Place> in_order(const std::vector<const SampleColumns*>& runs) {
  std::vector<Place> places;
  for (std::uint32_t r = 0; r < runs.size(); ++r)
    for (std::uint32_t i = 0; i < runs[r]->size(); ++i) places.push_back({runs[r]->time[i], r, i});
  const auto later_run_first = [](const Place& a, const Place& b) {
    return a.time != b.time ? a.time < b.time : a.run > b.run;
  };
  if (!std::is_sorted(places.begin(), places.end(), later_run_first))
    std::sort(places.begin(), places.end(), later_run_first);
  const auto at_one_time = [](const Place& a, const Place& b) { return a.time == b.time; };
  places.erase(std::unique(places.begin(), places.end(), at_one_time), places.end());
  return places;
}

}  // namespace

void overlay(SampleColumns& base, const std::vector<const SampleColumns*>& newer) {
  if (follow_each_other(base, newer)) {
    for (const SampleColumns* run : newer) base.append(*run, 0, run->size());
    return;
  }
  const std::vector<Place> places = in_order(newer);
  const auto first_touched = static_cast<std::size_t>(
      std::lower_bound(base.time.begin(), base.time.end(), places.front().time) -
      base.time.begin());
  SampleColumns merged;
  merged.append(base, 0, first_touched);
  std::size_t next = first_touched;
  for (const Place& place : places) {
    const auto before = static_cast<std::size_t>(
        std::lower_bound(base.time.begin() + static_cast<std::ptrdiff_t>(next), base.time.end(),
                         place.time) -
        base.time.begin());
    merged.append(base, next, before);
    next = before < base.size() && base.time[before] == place.time ? before + 1 : before;
    merged.append(*newer[place.run], place.at, place.at + 1);
  }
  merged.append(base, next, base.size());
  base = std::move(merged);
}

}  // namespace reident::storage
