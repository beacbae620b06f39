// Many samples of one series in few figures, for whoever draws or prints a long range.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "service/support/mutex.hpp"
#include "storage/archive/chunk_outline.hpp"
#include "storage/database/database.hpp"
#include "storage/types/quality.hpp"
#include "storage/types/series.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::history {

/// The samples of one bin. Extremes are of the values that are not NaN, each with the time at which
/// it came first.
struct BinSummary {
  storage::TimeRange bin;
  storage::Time first = 0, last = 0;  // of its samples
  std::uint64_t samples = 0;
  std::uint64_t numbers = 0;  // samples that are not NaN; 0: there are no extremes
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  storage::Time least_time = 0, greatest_time = 0;
  storage::Quality worst = storage::Quality::good;
};

struct SeriesSummary {
  std::vector<BinSummary> bins;  // ascending; those with samples alone
  /// Times between two neighbouring samples where others are missing, as far as they are not
  /// shorter than a bin: ascending.
  std::vector<storage::TimeRange> gaps;
};

/// What pieces of chunks came to, so that whoever asks about them again need not decode them. A
/// chunk that was written again is another one: what is kept stays right. Any thread.
class PieceMemory {
 public:
  /// `most`: pieces that are kept, of about 160 bytes each; beyond that all are forgotten.
  explicit PieceMemory(std::size_t most = 100'000) : most_(most) {}

  /// The part of a chunk in `range`; absent where it is not known.
  std::optional<BinSummary> find(const storage::ChunkOutline& chunk,
                                 storage::TimeRange range) const;
  void keep(const storage::ChunkOutline& chunk, const BinSummary& piece);

 private:
  struct Key {
    std::uint64_t chunk = 0;
    storage::TimeRange range;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  const std::size_t most_;
  mutable Mutex mutex_;
  std::unordered_map<Key, BinSummary, Hash> pieces_ REIDENT_GUARDED_BY(mutex_);
};

/// Summarises the samples of a series in the range of `bins`. Chunks that are spread over few bins
/// are decoded once for all questions with one memory. `go_on` is called in between, and may throw.
/// Throws storage::Error.
SeriesSummary summarise(const storage::Database& database, const storage::SeriesInfo& series,
                        const storage::TimeBins& bins, PieceMemory& memory,
                        const std::function<void()>& go_on = {});

}  // namespace reident::history
