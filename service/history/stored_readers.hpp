// The readers of a database file, also while a service writes it. Each call reads what is committed
// then: two calls are no snapshot.
#pragma once

#include "service/history/readers.hpp"
#include "storage/archive/archive.hpp"
#include "storage/archive/holdings.hpp"
#include "storage/registry/registry.hpp"

namespace reident::history {

/// The registry of a database, which must outlive it. Throws storage::Error.
class StoredHistory final : public HistoryReader {
 public:
  explicit StoredHistory(storage::Database& database) : database_(database), registry_(database) {}

  std::vector<storage::EquipmentName> equipment() const override;
  std::optional<storage::Hold> hold(const storage::EquipmentName& equipment) const override;
  std::vector<storage::Attempt> attempts(const storage::HistoryFilter& filter) const override;
  std::optional<storage::Attempt> attempt(const storage::EquipmentName& equipment,
                                          std::int64_t version) const override;
  std::vector<storage::VersionSummary> summaries(
      const storage::EquipmentName& equipment) const override;
  std::optional<storage::Version> version(const storage::EquipmentName& equipment,
                                          std::int64_t number) const override;
  std::vector<storage::Decision> decisions(const storage::EquipmentName& equipment,
                                           std::optional<std::int64_t> version) const override;
  std::optional<storage::Decision> champion_decision(
      const storage::EquipmentName& equipment, std::optional<storage::Time> time) const override;
  std::vector<OverviewRow> overview() const override;
  std::vector<WaitingRow> waiting() const override;
  std::vector<storage::Alarm> alarms() const override;
  std::vector<storage::SimulatorState> simulators() const override;
  std::vector<storage::Block> blocks(const storage::EquipmentName& equipment) const override;
  std::vector<storage::BlockScore> scores(const storage::EquipmentName& equipment,
                                          std::int64_t version) const override;

 private:
  storage::Database& database_;
  storage::Registry registry_;
};

/// The archive of a database, which must outlive it. Throws storage::Error.
class StoredTelemetry final : public TelemetryReader {
 public:
  explicit StoredTelemetry(storage::Database& database) : database_(database), archive_(database) {}

  std::optional<storage::ParameterDescriptor> parameter(const std::string& spacecraft,
                                                        const std::string& name) const override;
  storage::Series read(const std::string& spacecraft, storage::Origin origin,
                       std::uint32_t parameter, storage::TimeRange range) const override;
  std::vector<storage::SeriesInfo> series() const override;
  std::map<std::int64_t, std::string> source_names() const override;
  std::unique_ptr<SampleBatches> batches(const storage::SeriesInfo& series,
                                         storage::TimeRange range, std::size_t chunks,
                                         storage::WantedColumns wanted) const override;
  std::vector<storage::BinCounts> completeness(const storage::SeriesInfo& series,
                                               const storage::TimeBins& bins,
                                               storage::Time until) const override;
  std::vector<storage::SequenceGap> sequence_gaps() const override;

 private:
  storage::Database& database_;
  storage::Archive archive_;
};

}  // namespace reident::history
