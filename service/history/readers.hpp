// The questions that programs ask the registry and the archive, wherever these are: in a file
// (stored_readers.hpp), or behind a running service (remote_readers.hpp). Both give the same
// answers to the last bit; nothing here changes what it reads.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "service/history/overview_rows.hpp"
#include "storage/types/registry_rows.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/sample_reader.hpp"
#include "storage/types/series.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::history {

/// No answer; says what is wrong and what would mend it. Files throw storage::Error.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    refused,   // the service said why
    no_answer  // none in time
  };
  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// What was tried and decided. One thread at a time. Where an answer is absent, so is what was
/// asked for; every call throws where there can be no answer (Error, storage::Error).
class HistoryReader {
 public:
  virtual ~HistoryReader() = default;

  /// The equipment with attempts, in alphabetical order.
  virtual std::vector<storage::EquipmentName> equipment() const = 0;
  /// The hold in force; absent where the champion is not held.
  virtual std::optional<storage::Hold> hold(const storage::EquipmentName& equipment) const = 0;
  /// The attempts that the filter selects, ascending by id.
  virtual std::vector<storage::Attempt> attempts(const storage::HistoryFilter& filter) const = 0;
  /// The attempt that gave a version.
  virtual std::optional<storage::Attempt> attempt(const storage::EquipmentName& equipment,
                                                  std::int64_t version) const = 0;
  /// Every version of an equipment, ascending.
  virtual std::vector<storage::VersionSummary> summaries(
      const storage::EquipmentName& equipment) const = 0;
  /// A version with its model and provenance.
  virtual std::optional<storage::Version> version(const storage::EquipmentName& equipment,
                                                  std::int64_t number) const = 0;
  /// The decisions about an equipment, or one version of it, ascending by id.
  virtual std::vector<storage::Decision> decisions(
      const storage::EquipmentName& equipment,
      std::optional<std::int64_t> version = std::nullopt) const = 0;
  /// The decision that made the champion now, or at `time`; absent where there is none.
  virtual std::optional<storage::Decision> champion_decision(
      const storage::EquipmentName& equipment,
      std::optional<storage::Time> time = std::nullopt) const = 0;
  /// How things are now: equipment by name, versions that wait for an operator, alarms that are
  /// raised, simulators that are there.
  virtual std::vector<OverviewRow> overview() const = 0;
  virtual std::vector<WaitingRow> waiting() const = 0;
  virtual std::vector<storage::Alarm> alarms() const = 0;
  virtual std::vector<storage::SimulatorState> simulators() const = 0;
  /// The blocks of an equipment that versions were scored on, ascending.
  virtual std::vector<storage::Block> blocks(const storage::EquipmentName& equipment) const = 0;
  /// The scores of a version, ascending; without the states of its run.
  virtual std::vector<storage::BlockScore> scores(const storage::EquipmentName& equipment,
                                                  std::int64_t version) const = 0;
};

/// One series read forward, see storage::SeriesBatches. Its reader has to outlive it.
class SampleBatches {
 public:
  virtual ~SampleBatches() = default;
  /// The next samples in place of those that `batch` held; false, and none, at the end.
  virtual bool next(storage::SampleColumns& batch) = 0;
};

/// What was archived. One thread at a time. Throws as HistoryReader does; storage::Error (corrupt)
/// or Error (refused) where samples cannot be decoded.
class TelemetryReader : public storage::SampleReader {
 public:
  /// The series with samples, by spacecraft, origin and name.
  virtual std::vector<storage::SeriesInfo> series() const = 0;
  /// The names of sources by the ids that samples have.
  virtual std::map<std::int64_t, std::string> source_names() const = 0;
  /// The samples of a series in `range`, in order of time. `chunks` bounds the memory, as for
  /// storage::SeriesBatches; columns that are not `wanted` may be empty.
  virtual std::unique_ptr<SampleBatches> batches(const storage::SeriesInfo& series,
                                                 storage::TimeRange range, std::size_t chunks,
                                                 storage::WantedColumns wanted) const = 0;
  /// What came and what is missing in each bin, as storage::completeness counts it. `until`: how
  /// far the spacecraft's telemetry reaches.
  virtual std::vector<storage::BinCounts> completeness(const storage::SeriesInfo& series,
                                                       const storage::TimeBins& bins,
                                                       storage::Time until) const = 0;
  /// The frames that sources skipped, by source.
  virtual std::vector<storage::SequenceGap> sequence_gaps() const = 0;
};

}  // namespace reident::history
