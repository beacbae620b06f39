// Moves recent samples into chunks, a bounded step at a time. Private to storage.
//
// A round moves what was recent when it began. A step rewrites some ranges of some series and
// may end anywhere: fragments lie over chunks, so samples that are in both are there once. Only
// when all of a series is in chunks are its fragments passed over (`series.moved`), and only when
// that holds for every series are their rows removed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "storage/archive/chunk_store.hpp"
#include "storage/archive/postponed_samples.hpp"
#include "storage/archive/recent_tier.hpp"

namespace reident::storage {

class Compaction {
 public:
  /// Chunks that are filled in order of time have `chunk_samples` samples, others between half and
  /// one and a half of that.
  Compaction(RecentTier& recent, ChunkStore& chunks, PostponedSamples& postponed,
             std::size_t chunk_samples)
      : recent_(recent), chunks_(chunks), postponed_(postponed), chunk_samples_(chunk_samples) {}

  bool is_under_way() const { return round_.has_value(); }
  void begin();
  /// Rewrites about `samples` samples, and at the end of a round removes some rows. Within a
  /// transaction of the caller; after an Error the compaction, the tier and the store are to be
  /// made again.
  void step(std::size_t samples);

 private:
  struct Round {
    std::int64_t batch = 0;            // the last one that moves
    std::vector<std::int64_t> series;  // that still have to move, the next one last
    SampleColumns samples{};           // of the next one, from its fragments
    std::size_t done = 0;              // of `samples`
  };

  void gather(const SeriesHead& series);
  /// Moves samples of one range between two chunks; returns how many samples it wrote.
  std::size_t move_range(std::int64_t series);
  std::size_t postpone(std::int64_t series, std::size_t first, Time last, const ShardError& why);
  std::vector<std::size_t> piece_ends(std::size_t samples, bool at_the_end) const;

  RecentTier& recent_;
  ChunkStore& chunks_;
  PostponedSamples& postponed_;
  const std::size_t chunk_samples_;
  std::optional<Round> round_;
};

}  // namespace reident::storage
