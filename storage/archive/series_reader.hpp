// Samples of a series for readers: chunks, and what is recent over them. Private to storage.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/archive/chunk_outline.hpp"
#include "storage/chunks/chunk.hpp"
#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {

/// Every call sees one snapshot. Throws Error (corrupt) where samples cannot be decoded.
class SeriesReader {
 public:
  explicit SeriesReader(sqlite::Connection& connection)
      : connection_(connection), bytes_(connection) {}

  std::optional<std::int64_t> find(std::string_view spacecraft, Origin origin,
                                   std::uint32_t parameter);

  /// Samples with a time in `range`; with a batch, as it was after that one.
  SampleColumns read(std::int64_t series, TimeRange range, WantedColumns wanted = {},
                     std::optional<std::int64_t> as_of = std::nullopt);

  /// Times of the first and the last sample; those of no fragment meet no range.
  struct Extent {
    Time first = latest_time;
    Time last = earliest_time;
  };
  /// The fragments of the series that are not in chunks, ascending by batch.
  std::vector<Extent> recent(std::int64_t series);

  /// The chunks that lie in `range` and within which nothing recent lies, ascending.
  std::vector<ChunkOutline> outlines(std::int64_t series, TimeRange range);
  /// Puts the samples of a chunk in the place of those that `samples` held. False where the chunk
  /// is not there any more as it was.
  bool read(const ChunkOutline& chunk, WantedColumns wanted, SampleColumns& samples);

  std::optional<Time> first_at_or_after(std::int64_t series, Time time);
  std::optional<Time> last_at_or_before(std::int64_t series, Time time);

 private:
  /// Calls `use(row)` for each fragment that meets [first, last]; the row has the times of its
  /// first and last sample, their number and the bytes.
  template <typename Use>
  void each_recent(std::int64_t series, Time first, Time last, const Use& use);

  Extent extent_of(std::int64_t batch, std::int64_t series);

  sqlite::Connection& connection_;
  /// By batch and series. They are kept since a batch does not change until it goes.
  std::map<std::pair<std::int64_t, std::int64_t>, Extent> extents_;
  ChunkBytes bytes_;
  ChunkDecoder decoder_;
};

}  // namespace reident::storage
