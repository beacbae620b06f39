// Samples of one series in columns, as chunks and fragments hold them.
//
// Row i of every column is one sample. Times are nanoseconds and ascend strictly, so that a time
// names a sample. Values are in the parameter's unit, every bit of them kept, NaN and -0.0 too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Columns to be encoded, all of one length from 1 to most_samples (chunk.hpp). They are borrowed:
/// whoever owns them keeps them until the call returns.
struct ChunkSamples {
  std::span<const Time> time;
  std::span<const double> value;
  std::span<const Quality> quality;
  /// Ids of the sources that brought the samples.
  std::span<const std::int64_t> source;
};

/// Where decoded samples go: appended to each vector that is given. A column without a vector is
/// left out and costs nothing. Vectors are borrowed, and none is given twice.
struct ChunkTarget {
  std::vector<Time>* time = nullptr;
  std::vector<double>* value = nullptr;
  std::vector<Quality>* quality = nullptr;
  std::vector<std::int64_t>* source = nullptr;
};

/// Which columns are wanted in addition to the times. What is not wanted is not decoded, and its
/// column stays empty.
struct WantedColumns {
  bool value = true;
  bool quality = true;
  bool source = true;
};

/// What the archive holds at one time of a series.
struct Held {
  double value = 0;
  Quality quality = Quality::good;
  /// Id of the source that brought it.
  std::int64_t source = 0;
};

/// Owned columns. Times strictly ascend; the other columns are as long as the times, or empty where
/// they are not wanted. No member function checks this.
struct SampleColumns {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  /// Ids of the sources that brought the samples.
  std::vector<std::int64_t> source;

  /// How many samples there are, by the times.
  std::size_t size() const { return time.size(); }
  bool empty() const { return time.empty(); }
  /// The columns to be encoded; valid until they change.
  ChunkSamples samples() const { return {time, value, quality, source}; }
  /// These columns as a target, those of `wanted` alone; valid as long as this object.
  ChunkTarget target(WantedColumns wanted = {}) {
    return {&time, wanted.value ? &value : nullptr, wanted.quality ? &quality : nullptr,
            wanted.source ? &source : nullptr};
  }
  /// Appends a sample to all four columns. `at` is above the last time.
  void push_back(Time at, const Held& sample);
  /// Appends the samples [first, last) of `other`, which has them. Columns that are empty there
  /// stay as they are.
  void append(const SampleColumns& other, std::size_t first, std::size_t last);
  /// Keeps the first `count` samples; shorter columns stay as they are.
  void cut(std::size_t count);
  /// Makes room for `count` samples in the times and the wanted columns, so that appending them
  /// allocates nothing.
  void reserve(std::size_t count, WantedColumns wanted = {});
};

}  // namespace reident::storage
