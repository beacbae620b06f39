// Samples of a chunk, made and compared by their bits.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "storage/chunks/chunk.hpp"

namespace reident::storage::test {

struct Columns {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;

  ChunkSamples samples() const { return {time, value, quality, source}; }
  ChunkTarget target() { return {&time, &value, &quality, &source}; }
};

inline std::vector<std::uint64_t> bits_of(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits;
  for (const double value : values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

/// Equal to the last bit, which == on doubles does not compare.
inline bool same(const Columns& a, const Columns& b) {
  return a.time == b.time && bits_of(a.value) == bits_of(b.value) && a.quality == b.quality &&
         a.source == b.source;
}

/// 1 Hz, good, from source 1.
inline Columns columns_of(const std::vector<double>& values) {
  Columns columns;
  columns.value = values;
  for (std::size_t i = 0; i < values.size(); ++i)
    columns.time.push_back(1'500'000'000'000'000'000 + static_cast<Time>(i) * 1'000'000'000);
  columns.quality.assign(values.size(), Quality::good);
  columns.source.assign(values.size(), 1);
  return columns;
}

/// The samples at times in [begin, end), as a decoder with a range should give them.
inline Columns cut(const Columns& columns, TimeRange range) {
  Columns inside;
  for (std::size_t i = 0; i < columns.time.size(); ++i) {
    if (columns.time[i] < range.begin || columns.time[i] >= range.end) continue;
    inside.time.push_back(columns.time[i]);
    inside.value.push_back(columns.value[i]);
    inside.quality.push_back(columns.quality[i]);
    inside.source.push_back(columns.source[i]);
  }
  return inside;
}

}  // namespace reident::storage::test
