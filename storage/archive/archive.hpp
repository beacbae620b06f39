// Every telemetry sample that was received, once.
//
// A sample's identity is (spacecraft, origin, parameter, generation time). The same sample twice is
// one sample. Of two values for one identity the better quality wins, then the first. Values are
// the same when their bits are, and all NaNs are one value. Where a frame of the satellite brings
// another good value than the one that is there, by more than rounding, that one stays for ever
// with the quality `disputed`. A parameter needs no descriptor to be archived.
//
// Every function may throw Error where the file or the disk refuses (error.hpp has the kinds); what
// is said below of throwing is in addition to that.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/database/database.hpp"
#include "storage/types/sample_reader.hpp"
#include "storage/types/series.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// What one append did. Samples are counted once each: stored + duplicates + conflicts. `late` and
/// `non_finite` count some of them again.
struct AppendReport {
  std::uint64_t frames = 0;
  std::uint64_t stored = 0;
  std::uint64_t duplicates = 0;  // same identity, same value; the better quality is kept
  std::uint64_t conflicts = 0;   // same identity, another value
  std::uint64_t late = 0;        // stored behind a newer sample of its series
  std::uint64_t non_finite = 0;  // NaN or infinite, repeated ones too; stored as invalid

  /// The range of time in which samples of one series landed or changed.
  struct Touched {
    std::string spacecraft;
    Origin origin = Origin::real;
    std::uint32_t parameter = 0;
    TimeRange range;
  };
  std::vector<Touched> touched;  // of samples too that waited for a shard until now

  /// A run of a source whose first frame here was not the first that was sent.
  struct LateStart {
    std::string spacecraft;
    std::string source;
    std::uint64_t came = 0;   // number of the first frame that came
    std::uint64_t first = 0;  // with which the run began; 0: the source does not say
  };
  std::vector<LateStart> late_starts;

  /// Samples that were found damaged in the file and set aside (SCHEMA.md), in words.
  std::vector<std::string> damages;
  /// Which shard late samples wait for, of this and of earlier appends, and the remedy. Empty while
  /// none does.
  std::string postponed;
};

/// How the writer arranges samples, in numbers of samples; the defaults suit any archive.
/// SCHEMA.md, "Samples", says what each of them costs and saves.
struct ArchiveOptions {
  std::size_t chunk_samples = 12288;  // of a chunk that is filled in order of time; 16 to 65536
  std::size_t recent_samples = 1'000'000;  // that wait for a place in chunks; at most twice as many
  std::size_t recent_batches = 256;        // appends that wait
  std::size_t step_samples = 65536;        // that a transaction moves at least: a few milliseconds
};

/// A range of sealed time (see Archive::seal) in which samples of one series landed or changed.
/// Ranges of a series that are no more than 10 minutes apart are one.
struct LateRange {
  std::int64_t id = 0;  // never used again
  std::string spacecraft;
  Origin origin = Origin::real;
  std::uint32_t parameter = 0;
  TimeRange range;
};

/// The telemetry in a database. Any number of archives may be made on one database; they share its
/// writer. Functions that are not const need a database that is opened for writing, and throw Error
/// (read_only) elsewhere.
class Archive : public SampleReader {
 public:
  /// The database must outlive the archive. The options are the writer's: those of the archive that
  /// appends first hold for the database.
  explicit Archive(Database& database, const ArchiveOptions& options = {});

  Database& database() { return database_; }
  const ArchiveOptions& options() const { return options_; }

  /// Stores the frames, which may be of any spacecraft and source and in any order, in one
  /// transaction. A bounded share of moving older samples into chunks is part of it. Returns what
  /// became of the samples. Throws Error where not all of it can be stored; then nothing is.
  AppendReport append(std::span<const TelemetryFrame> frames);
  /// Moves all samples into chunks, in many bounded transactions. Never needed: it saves room.
  void compact();
  /// Adds descriptors, or replaces those of the same spacecraft and id. One transaction.
  void describe(std::span<const ParameterDescriptor> descriptors);

  /// Says that a window which ends at `end` is about to be read: from now on append() marks what
  /// lands or changes before `end`, in the transaction that stores it. Seal first, then read the
  /// window, so that nothing is missed. The seal only moves forward and outlives a crash.
  void seal(const std::string& spacecraft, Time end);
  /// Marks that were not forgotten yet, ascending by id.
  std::vector<LateRange> late_ranges(const std::string& spacecraft) const;
  /// Removes marks whose windows were evaluated again. A mark that grew since it was read has
  /// another id and stays.
  void forget_late(std::span<const LateRange> ranges);

  /// Every spacecraft that has samples or descriptors, in alphabetical order.
  std::vector<std::string> spacecraft() const;
  /// Descriptors of the spacecraft's parameters, ascending by id.
  std::vector<ParameterDescriptor> parameters(const std::string& spacecraft) const;
  std::optional<ParameterDescriptor> parameter(const std::string& spacecraft,
                                               const std::string& name) const override;

  /// Samples of one series with a generation time in `range`, from one snapshot; none where the
  /// series is not known. `source` stays empty. Throws Error (corrupt) where samples of the range
  /// cannot be decoded, with parameter, time and remedy.
  Series read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
              TimeRange range) const override;
  /// As read(), with the ids of the sources.
  Series read_with_sources(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
                           TimeRange range) const;
  /// Batches that changed samples of the series in `range` after that time was sealed, the latest
  /// first. Each one's number is an argument of before().
  std::vector<std::int64_t> revisions(const std::string& spacecraft, Origin origin,
                                      std::uint32_t parameter, TimeRange range) const;
  /// An archive on the same database whose read() gives sealed time as it was before this batch.
  Archive before(std::int64_t batch) const;
  /// Generation time of the series' nearest sample on one side of `time`, itself included; absent
  /// where there is none.
  std::optional<Time> first_at_or_after(const std::string& spacecraft, Origin origin,
                                        std::uint32_t parameter, Time time) const;
  std::optional<Time> last_at_or_before(const std::string& spacecraft, Origin origin,
                                        std::uint32_t parameter, Time time) const;

  /// From the first sample to just after the last one of a spacecraft's series of this origin;
  /// absent when there is none.
  std::optional<TimeRange> extent(const std::string& spacecraft, Origin origin) const;

  /// Samples of all series together.
  std::uint64_t sample_count() const;
  /// Counts of every source, by spacecraft, name and origin.
  std::vector<SourceCounts> sources() const;
  /// Every gap of every source, in the order of sources(), then by run and number. There may be
  /// many: each_sequence_gap() in holdings.hpp gives one at a time.
  std::vector<SequenceGap> sequence_gaps() const;

 private:
  Series read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
              TimeRange range, bool with_sources) const;

  Database& database_;
  ArchiveOptions options_;
  std::optional<std::int64_t> as_of_{};  // the last batch that read() knows of
};

}  // namespace reident::storage
