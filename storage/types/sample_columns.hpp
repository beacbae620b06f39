// Samples of one series in columns, as chunks and recent runs hold them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Columns of one length, 1 to most_samples; times strictly ascend.
struct ChunkSamples {
  std::span<const Time> time;
  std::span<const double> value;
  std::span<const Quality> quality;
  std::span<const std::int64_t> source;  // id of the source that brought the sample
};

/// Where decoded samples go: appended to each vector that is given; a column without one is left
/// out and costs nothing.
struct ChunkTarget {
  std::vector<Time>* time = nullptr;
  std::vector<double>* value = nullptr;
  std::vector<Quality>* quality = nullptr;
  std::vector<std::int64_t>* source = nullptr;
};

/// Beside the times; what is not wanted is not decoded, and its column stays empty.
struct WantedColumns {
  bool value = true;
  bool quality = true;
  bool source = true;
};

/// What the archive holds at one time of a series.
struct Held {
  double value = 0;
  Quality quality = Quality::good;
  std::int64_t source = 0;
};

/// Times strictly ascend; the other columns are as long as the times, or empty where they are not
/// wanted.
struct SampleColumns {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;  // id of the source that brought the sample

  std::size_t size() const { return time.size(); }
  bool empty() const { return time.empty(); }
  ChunkSamples samples() const { return {time, value, quality, source}; }
  ChunkTarget target(WantedColumns wanted = {}) {
    return {&time, wanted.value ? &value : nullptr, wanted.quality ? &quality : nullptr,
            wanted.source ? &source : nullptr};
  }
  void push_back(Time at, const Held& sample);
  /// Appends the samples [first, last) of `other`, in its wanted columns.
  void append(const SampleColumns& other, std::size_t first, std::size_t last);
  /// Keeps the first `count` samples.
  void cut(std::size_t count);
  void reserve(std::size_t count, WantedColumns wanted = {});
};

}  // namespace reident::storage
