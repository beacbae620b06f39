#include "storage/chunks/overlay.hpp"

#include <algorithm>
#include <cstdint>

namespace reident::storage {
namespace {

struct Place {
  Time time;
  std::uint32_t fragment;
  std::uint32_t at;
};

bool follow_each_other(const SampleColumns& base, const std::vector<const SampleColumns*>& newer) {
  const SampleColumns* last = &base;
  for (const SampleColumns* fragment : newer) {
    if (fragment->empty()) continue;
    if (!last->empty() && last->time.back() >= fragment->time.front()) return false;
    last = fragment;
  }
  return true;
}

void make_room(SampleColumns& base, const std::vector<const SampleColumns*>& newer) {
  std::size_t size = base.size();
  WantedColumns has{.value = false, .quality = false, .source = false};
  for (const SampleColumns* fragment : newer) {
    size += fragment->size();
    has.value |= !fragment->value.empty();
    has.quality |= !fragment->quality.empty();
    has.source |= !fragment->source.empty();
  }
  base.reserve(size, has);
}

/// All samples of the fragments in order of time, the one that stays at each time alone.
std::vector<Place> in_order(const std::vector<const SampleColumns*>& fragments) {
  std::vector<Place> places;
  for (std::uint32_t r = 0; r < fragments.size(); ++r)
    for (std::uint32_t i = 0; i < fragments[r]->size(); ++i)
      places.push_back({fragments[r]->time[i], r, i});
  const auto later_fragment_first = [](const Place& a, const Place& b) {
    return a.time != b.time ? a.time < b.time : a.fragment > b.fragment;
  };
  if (!std::is_sorted(places.begin(), places.end(), later_fragment_first))
    std::sort(places.begin(), places.end(), later_fragment_first);
  const auto at_one_time = [](const Place& a, const Place& b) { return a.time == b.time; };
  places.erase(std::unique(places.begin(), places.end(), at_one_time), places.end());
  return places;
}

}  // namespace

void overlay(SampleColumns& base, const std::vector<const SampleColumns*>& newer) {
  if (follow_each_other(base, newer)) {
    make_room(base, newer);
    for (const SampleColumns* fragment : newer) base.append(*fragment, 0, fragment->size());
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
    merged.append(*newer[place.fragment], place.at, place.at + 1);
  }
  merged.append(base, next, base.size());
  base = std::move(merged);
}

}  // namespace reident::storage
