// One series as blocks of columns: its chunks, decoded one after the other, under its recent
// samples.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "storage/sql/archive_file.hpp"
#include "storage/sql/selection.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage::sql {

class SeriesBlocks {
 public:
  struct Options {
    WantedColumns wanted;
    bool descending = false;
    std::size_t most_rows = most_samples;  // of a block that comes from a chunk
  };
  /// `file` and `selection` must outlive it; of the selection what concerns samples is used.
  SeriesBlocks(ArchiveFile& file, const SeriesName& series, const Selection& selection,
               const Options& options);

  /// Goes to the next block that has a row; false at the end.
  bool next();
  /// The chunk that comes next, if all of it is wanted as it is, nothing recent lies within it and
  /// `fits` says so; it is then passed over.
  std::optional<ChunkEntry> take_undecoded(const std::function<bool(const ChunkEntry&)>& fits);
  /// In the order asked for: descending columns are turned round.
  const SampleColumns& block() const { return block_; }
  const SeriesName& series() const { return series_; }

 private:
  bool load();
  bool filters() const;
  void leave(TimeBounds piece);
  std::optional<ChunkEntry> next_chunk();
  bool comes_before(TimeBounds fragment, const ChunkEntry& chunk) const;
  void end_before(const ChunkEntry& chunk, TimeBounds& piece) const;
  void end_with(TimeBounds range, TimeBounds& piece) const;
  void load_chunk(const ChunkEntry& chunk, TimeBounds& piece);
  void filter();

  ArchiveFile& file_;
  SeriesName series_;
  const Selection& selection_;
  Options options_;
  TimeBounds left_;  // not yet read
  SampleColumns block_;
};

}  // namespace reident::storage::sql
