#include "storage/types/sample_columns.hpp"

#include <algorithm>

namespace reident::storage {

void SampleColumns::push_back(Time at, const Held& sample) {
  time.push_back(at);
  value.push_back(sample.value);
  quality.push_back(sample.quality);
  source.push_back(sample.source);
}

void SampleColumns::append(const SampleColumns& other, std::size_t first, std::size_t last) {
  const auto copy = [first, last](const auto& from, auto& to) {
    if (from.empty()) return;
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last));
  };
  copy(other.time, time);
  copy(other.value, value);
  copy(other.quality, quality);
  copy(other.source, source);
}

void SampleColumns::cut(std::size_t count) {
  time.resize(std::min(count, time.size()));
  value.resize(std::min(count, value.size()));
  quality.resize(std::min(count, quality.size()));
  source.resize(std::min(count, source.size()));
}

void SampleColumns::reserve(std::size_t count, WantedColumns wanted) {
  time.reserve(count);
  if (wanted.value) value.reserve(count);
  if (wanted.quality) quality.reserve(count);
  if (wanted.source) source.reserve(count);
}

}  // namespace reident::storage
