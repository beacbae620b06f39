// What an archive holds: its series, the counts of its sources and the gaps in their numbering.
//
// A series is the samples of one parameter of one origin. Counts go on over restarts of the
// program; they are those of the file.
#pragma once

#include <cstdint>
#include <string>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// One series that has samples.
struct SeriesInfo {
  /// Never used for another series of the file.
  std::int64_t id = 0;
  std::string spacecraft;
  Origin origin = Origin::real;
  /// Its number within the spacecraft.
  std::uint32_t parameter = 0;
  /// The descriptor's; else the parameter's number.
  std::string name;
  /// What is there, without what retention removed.
  std::uint64_t samples = 0;
  /// Generation times of the first and the last sample.
  Time first = 0;
  Time last = 0;
};

/// Counts of one source since the archive was made. Of its samples,
/// samples - duplicates - conflicts were stored as new ones. Retention takes nothing off.
struct SourceCounts {
  std::string spacecraft;
  std::string source;
  Origin origin = Origin::real;
  /// Frames, with a sequence number and without.
  std::uint64_t frames = 0;
  /// What AppendReport counts of each append (archive.hpp), added up.
  std::uint64_t samples = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t conflicts = 0;
  std::uint64_t late = 0;
  std::uint64_t non_finite = 0;
  /// Frames whose sequence number is not above the highest before them.
  std::uint64_t out_of_order = 0;
  /// Times that the source began to count again.
  std::uint64_t restarts = 0;
  /// Sequence numbers that were skipped and have not come since.
  std::uint64_t missing = 0;
  /// The highest since the last restart.
  std::uint64_t last_sequence = 0;
};

/// Sequence numbers of a source that have not come.
struct SequenceGap {
  std::string spacecraft;
  std::string source;
  Origin origin = Origin::real;
  /// The first and the last of them, both missing.
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  /// Generation times of the frames on either side of the gap.
  Time before = 0;
  Time after = 0;
};

/// The place of a sequence gap among all, ascending by source, run and first number.
struct GapKey {
  /// Id of the source.
  std::int64_t source = 0;
  /// Restarts of the source before the gap.
  std::int64_t run = 0;
  /// The first missing number as the file holds it, with its highest bit inverted.
  std::int64_t first = 0;
};

}  // namespace reident::storage
