// Which frames of a source are missing, by their sequence numbers. Private to storage.
//
// The archive keeps for each source the lowest and highest number of its current run and the gaps
// between them. A frame either goes on (above the highest), fills a gap, or comes below the lowest
// within `reorder_limit` (reordered at the start, or played backwards). Any other frame was seen:
// if it brings samples that the archive did not know, the source has begun to count again, and a
// new run starts; else it is a repetition. Gaps of earlier runs stay as they are. Where a source
// says with which number its run began, what came before the first frame of the run is a gap too.
#pragma once

#include <cstdint>

#include "storage/database/sqlite.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

inline constexpr std::uint64_t reorder_limit = 64;

/// SQLite's integers are signed: with its highest bit inverted a sequence number keeps its order.
constexpr std::int64_t to_column(std::uint64_t sequence) {
  return static_cast<std::int64_t>(sequence ^ (std::uint64_t{1} << 63));
}
constexpr std::uint64_t from_column(std::int64_t column) {
  return static_cast<std::uint64_t>(column) ^ (std::uint64_t{1} << 63);
}

class SequenceTracker {
 public:
  struct Mark {
    std::uint64_t sequence = 0;
    Time time = 0;  // generation time of the frame
  };

  std::int64_t source = 0;  // id in the table
  // In the current run. The lowest is above the highest until a frame with a number has come.
  Mark lowest{1, 0}, highest{0, 0};
  std::uint64_t out_of_order = 0;
  std::uint64_t restarts = 0;  // also the number of the current run
  std::uint64_t missing = 0;   // modulo 2^64; exact below that

  /// `first` is the first number of the source's run; 0 where the source does not say. Returns
  /// whether a run began with this frame.
  bool observe(sqlite::Connection& connection, Mark frame, std::uint64_t first, bool brings_new);

 private:
  void begin_run(sqlite::Connection& connection, Mark frame, std::uint64_t first);
  void add_gap(sqlite::Connection& connection, Mark before, Mark after);
  bool fill_gap(sqlite::Connection& connection, Mark frame);
};

}  // namespace reident::storage
