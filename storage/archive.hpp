// Every telemetry sample that was received, once.
//
// A sample's identity is (spacecraft, origin, parameter, generation time). The same sample twice is
// one sample; of two values for one identity the better quality wins, then the first. A parameter
// needs no descriptor to be archived.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/database.hpp"
#include "storage/telemetry.hpp"

namespace reident::storage {

/// What one append did. Samples are counted once each: stored + duplicates + conflicts.
struct AppendReport {
  std::uint64_t frames = 0;
  std::uint64_t stored = 0;
  std::uint64_t duplicates = 0;  // same identity, same value
  std::uint64_t conflicts = 0;   // same identity, another value
  std::uint64_t late = 0;        // stored behind a newer sample of its series
  std::uint64_t non_finite = 0;  // NaN or infinite; stored as invalid

  /// The stretch of time in which new samples of one series landed.
  struct Touched {
    std::string spacecraft;
    Origin origin = Origin::real;
    std::uint32_t parameter = 0;
    TimeRange range;
  };
  std::vector<Touched> touched;
};

/// Samples of one series, ascending in time.
struct Series {
  std::vector<Time> time;
  std::vector<double> value;  // NaN where none could be stored
  std::vector<Quality> quality;
};

/// Counts of one source since the archive was made.
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
  std::uint64_t out_of_order = 0;  // frames whose sequence is not above the one before
  std::uint64_t missing = 0;       // sequence numbers that were skipped and have not come since
  std::uint64_t last_sequence = 0;
};

/// Sequence numbers [first, last] of a source that have not come.
struct SequenceGap {
  std::string spacecraft;
  std::string source;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

class Archive {
 public:
  /// The database must outlive the archive.
  explicit Archive(Database& database);

  /// One transaction: all of it is stored, or (Error thrown) none.
  AppendReport append(std::span<const TelemetryFrame> frames);
  void describe(std::span<const ParameterDescriptor> descriptors);

  std::vector<std::string> spacecraft() const;
  std::vector<ParameterDescriptor> parameters(const std::string& spacecraft) const;
  std::optional<ParameterDescriptor> parameter(const std::string& spacecraft,
                                               const std::string& name) const;

  /// Samples with a generation time in `range`.
  Series read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
              TimeRange range) const;

  /// From the first sample to just after the last one of a spacecraft's series of this origin;
  /// absent when there is none.
  std::optional<TimeRange> extent(const std::string& spacecraft, Origin origin) const;

  std::uint64_t sample_count() const;
  std::vector<SourceCounts> sources() const;
  std::vector<SequenceGap> sequence_gaps() const;

 private:
  Database& database_;
};

}  // namespace reident::storage
