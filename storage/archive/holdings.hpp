// What is archived, series by series, and its samples in stretches: for those who take a whole
// archive through their hands, such as an export.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "storage/database/database.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/series.hpp"

namespace reident::storage {

/// Those with samples, by spacecraft, origin and name.
std::vector<SeriesInfo> all_series(const Database& database);

/// Id of a series; absent where nothing of it was archived.
std::optional<std::int64_t> series_id(const Database& database, const std::string& spacecraft,
                                      Origin origin, std::uint32_t parameter);

/// Calls `visit` with one gap at a time that lies beyond `beyond`, until it answers false.
void each_sequence_gap(const Database& database, const std::optional<GapKey>& beyond,
                       const std::function<bool(const GapKey&, SequenceGap&&)>& visit);

/// Names of the sources by their ids.
std::map<std::int64_t, std::string> source_names(const Database& database);

/// Reads one series forward. Each stretch is a snapshot of its own.
class SeriesBatches {
 public:
  /// `chunks` bounds the memory: a stretch has the samples of so many chunks, and what is recent.
  /// The database must outlive this object.
  SeriesBatches(const Database& database, std::int64_t series, TimeRange range, std::size_t chunks,
                WantedColumns wanted);

  /// The next samples in place of those that `stretch` held; false, and none, at the end. Throws
  /// Error (corrupt) where they cannot be decoded.
  bool next(SampleColumns& stretch);

 private:
  const Database* database_;
  std::int64_t series_;
  TimeRange range_;  // what is left
  std::size_t chunks_;
  WantedColumns wanted_;
  bool at_end_ = false;
};

}  // namespace reident::storage
