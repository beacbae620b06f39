// What is archived, series by series, and its samples in batches: for those who read a whole
// archive, such as an export. All of it works on a database that is opened for reading, and throws
// Error where the file cannot be read.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "storage/archive/chunk_outline.hpp"
#include "storage/database/database.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/series.hpp"

namespace reident::storage {

/// Every series with samples, by spacecraft, origin and name.
std::vector<SeriesInfo> all_series(const Database& database);

/// Id of a series; absent where nothing of it was ever archived.
std::optional<std::int64_t> series_id(const Database& database, const std::string& spacecraft,
                                      Origin origin, std::uint32_t parameter);

/// Calls `visit` with one gap at a time, ascending by key, until it answers false. With `beyond`
/// only gaps after that key, so that a reading can go on where another one ended.
void each_sequence_gap(const Database& database, const std::optional<GapKey>& beyond,
                       const std::function<bool(const GapKey&, SequenceGap&&)>& visit);

/// Chunks of samples that could not be decoded and were set aside.
std::size_t damaged_chunks(const Database& database);

/// Names of all sources by the ids that samples have (SampleColumns::source).
std::map<std::int64_t, std::string> source_names(const Database& database);

/// The chunks that lie in `range` and hold all that the series has between their ends, ascending.
/// What is recent, or in a chunk that reaches out of the range, is in none of them.
std::vector<ChunkOutline> chunk_outlines(const Database& database, std::int64_t series,
                                         TimeRange range);
/// Puts the samples of a chunk in the place of those that `samples` held. False, with none, where
/// it was written again since. Throws Error (corrupt) where it cannot be decoded.
bool read_chunk(const Database& database, const ChunkOutline& chunk, WantedColumns wanted,
                SampleColumns& samples);

/// Reads one series forward, a batch at a time. Each batch is a snapshot of its own, so that a
/// long reading does not keep the log from being folded. What lands before the place that it has
/// reached is not seen.
class SeriesBatches {
 public:
  /// Reads the samples of `series`, an id, in `range`. `chunks`, at least 1, bounds the memory: a
  /// batch has the samples of so many chunks, and what is recent. Columns that are not `wanted`
  /// stay empty. The database must outlive this object.
  SeriesBatches(const Database& database, std::int64_t series, TimeRange range, std::size_t chunks,
                WantedColumns wanted);

  /// Puts the next samples in the place of those that `batch` held, ascending in time and at
  /// least one. False, with an empty batch, at the end. Throws Error (corrupt) where samples
  /// cannot be decoded.
  bool next(SampleColumns& batch);

 private:
  const Database* database_;
  std::int64_t series_;
  TimeRange range_;  // what is left
  std::size_t chunks_;
  WantedColumns wanted_;
  bool at_end_ = false;
};

}  // namespace reident::storage
