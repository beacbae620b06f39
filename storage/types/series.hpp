// What an archive holds: its series, the counts of its sources and the gaps in their numbering.
#pragma once

#include <cstdint>
#include <string>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

struct SeriesInfo {
  std::int64_t id = 0;
  std::string spacecraft;
  Origin origin = Origin::real;
  std::uint32_t parameter = 0;
  std::string name;  // the descriptor's; else the parameter's number
  std::uint64_t samples = 0;
  Time first = 0;
  Time last = 0;
};

/// Counts of one source since the archive was made. Of its samples,
/// samples - duplicates - conflicts were stored as new ones.
struct SourceCounts {
  std::string spacecraft;
  std::string source;
  Origin origin = Origin::real;
  std::uint64_t frames = 0;
  std::uint64_t samples = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t conflicts = 0;
  std::uint64_t late = 0;
  std::uint64_t non_finite = 0;
  std::uint64_t out_of_order = 0;   // frames whose sequence is not above the highest before them
  std::uint64_t restarts = 0;       // times that the source began to count again
  std::uint64_t missing = 0;        // sequence numbers that were skipped and have not come since
  std::uint64_t last_sequence = 0;  // the highest since the last restart
};

/// Sequence numbers [first, last] of a source that have not come. The frames on either side of the
/// gap have the generation times `before` and `after`.
struct SequenceGap {
  std::string spacecraft;
  std::string source;
  Origin origin = Origin::real;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  Time before = 0;
  Time after = 0;
};

/// Which of a source's gaps: ascending.
struct GapKey {
  std::int64_t source = 0;
  std::int64_t run = 0;
  std::int64_t first = 0;
};

}  // namespace reident::storage
