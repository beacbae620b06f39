// Many samples in one row: their number, mean, extremes, ends.
//
// SQLite asks a virtual table for each row and column by itself, which costs more than decoding the
// sample. Here whole columns are taken at once, and a chunk that lies in one range is not even
// decoded where its row in the table chunk says enough.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "storage/sql/archive_file.hpp"
#include "storage/sql/selection.hpp"
#include "storage/sql/series_blocks.hpp"

namespace reident::storage::sql {

/// Samples of one range of time of a series. Values that are NaN count as samples alone.
struct Summary {
  std::optional<Time> bucket{};  // begin of the range, a multiple of the step; none without a step
  Time first_time = 0;
  Time last_time = 0;
  std::uint64_t samples = 0;
  std::uint64_t numbers = 0;                               // samples that are not NaN
  double sum = 0;                                          // of them
  double least = std::numeric_limits<double>::infinity();  // of them; above `greatest` without one
  double greatest = -std::numeric_limits<double>::infinity();
  double first_value = 0;
  double last_value = 0;
  Time least_time = 0, greatest_time = 0;  // of the first sample with that value
  Quality worst_quality = Quality::good;
};

struct SummaryRequest {
  Selection selection;
  std::optional<std::int64_t> step;  // [ns], > 0; one range in all without one
  bool extremes = false;             // least and greatest are asked for
  bool values = false;               // sum, numbers, first and last value are
  bool times = false;                // least_time and greatest_time are
  bool quality = false;              // worst_quality is

  /// Whether every sample has to be looked at.
  bool needs_rows() const { return values || times || quality; }
};

/// Summaries of the ranges that have samples, series by series, each in order of time.
class Summaries {
 public:
  /// `file` must outlive it.
  Summaries(ArchiveFile& file, SummaryRequest request);
  Summaries(const Summaries&) = delete;  // blocks point into it
  Summaries& operator=(const Summaries&) = delete;

  /// Goes to the next one; false at the end.
  bool next();
  const Summary& summary() const { return summary_; }
  const SeriesName& series() const { return series_[at_]; }

 private:
  std::optional<Time> bucket_of(Time time) const;
  bool next_of_series();
  bool has_more();
  void add_rows();
  void add_values_of(std::size_t count);
  void add_chunk();

  ArchiveFile& file_;
  SummaryRequest request_;
  std::vector<SeriesName> series_;
  std::size_t at_ = 0;
  std::unique_ptr<SeriesBlocks> blocks_;  // of series_[at_]
  std::optional<ChunkEntry> chunk_;       // to be added next, else
  std::size_t row_ = 0;                   // of the block
  Summary summary_;
};

}  // namespace reident::storage::sql
