#include "service/history/stored_readers.hpp"

#include <utility>

#include "service/history/overview.hpp"
#include "storage/care/completeness.hpp"

namespace reident::history {

using storage::EquipmentName;

std::vector<EquipmentName> StoredHistory::equipment() const {
  return registry_.equipment();
}

std::optional<storage::Hold> StoredHistory::hold(const EquipmentName& equipment) const {
  return registry_.hold(equipment.spacecraft, equipment.equipment);
}

std::vector<storage::Attempt> StoredHistory::attempts(const storage::HistoryFilter& filter) const {
  return registry_.attempts(filter);
}

std::optional<storage::Attempt> StoredHistory::attempt(const EquipmentName& equipment,
                                                       std::int64_t version) const {
  std::optional<storage::Attempt> found;
  storage::RowFilter filter;
  filter.spacecraft = equipment.spacecraft;
  filter.equipment = equipment.equipment;
  filter.version = version;
  registry_.each_attempt(filter, [&found](storage::Attempt&& attempt) {
    found = std::move(attempt);
    return false;
  });
  return found;
}

std::vector<storage::VersionSummary> StoredHistory::summaries(
    const EquipmentName& equipment) const {
  return registry_.summaries(equipment.spacecraft, equipment.equipment);
}

std::optional<storage::Version> StoredHistory::version(const EquipmentName& equipment,
                                                       std::int64_t number) const {
  return registry_.version(equipment.spacecraft, equipment.equipment, number);
}

std::vector<storage::Decision> StoredHistory::decisions(const EquipmentName& equipment,
                                                        std::optional<std::int64_t> version) const {
  return registry_.decisions(equipment.spacecraft, equipment.equipment, version);
}

std::optional<storage::Decision> StoredHistory::champion_decision(
    const EquipmentName& equipment, std::optional<storage::Time> time) const {
  return registry_.champion_decision(equipment.spacecraft, equipment.equipment, time);
}

std::vector<OverviewRow> StoredHistory::overview() const {
  return history::overview(database_);
}

std::vector<WaitingRow> StoredHistory::waiting() const {
  return history::waiting(registry_);
}

std::vector<storage::Alarm> StoredHistory::alarms() const {
  return registry_.alarms();
}

std::vector<storage::SimulatorState> StoredHistory::simulators() const {
  return registry_.simulators();
}

std::vector<storage::Block> StoredHistory::blocks(const EquipmentName& equipment) const {
  return registry_.blocks(equipment.spacecraft, equipment.equipment, INT64_MIN);
}

std::vector<storage::BlockScore> StoredHistory::scores(const EquipmentName& equipment,
                                                       std::int64_t version) const {
  return registry_.scores(equipment.spacecraft, equipment.equipment, version, INT64_MIN);
}

std::optional<storage::ParameterDescriptor> StoredTelemetry::parameter(
    const std::string& spacecraft, const std::string& name) const {
  return archive_.parameter(spacecraft, name);
}

storage::Series StoredTelemetry::read(const std::string& spacecraft, storage::Origin origin,
                                      std::uint32_t parameter, storage::TimeRange range) const {
  return archive_.read(spacecraft, origin, parameter, range);
}

std::vector<storage::SeriesInfo> StoredTelemetry::series() const {
  return storage::all_series(database_);
}

std::map<std::int64_t, std::string> StoredTelemetry::source_names() const {
  return storage::source_names(database_);
}

std::unique_ptr<SampleBatches> StoredTelemetry::batches(const storage::SeriesInfo& series,
                                                        storage::TimeRange range,
                                                        std::size_t chunks,
                                                        storage::WantedColumns wanted) const {
  struct OfFile final : SampleBatches {
    explicit OfFile(storage::SeriesBatches&& batches) : reader(std::move(batches)) {}
    bool next(storage::SampleColumns& batch) override { return reader.next(batch); }
    storage::SeriesBatches reader;
  };
  return std::make_unique<OfFile>(
      storage::SeriesBatches(database_, series.id, range, chunks, wanted));
}

std::vector<storage::BinCounts> StoredTelemetry::completeness(const storage::SeriesInfo& series,
                                                              const storage::TimeBins& bins,
                                                              storage::Time until) const {
  return storage::completeness(database_, series, bins, until);
}

std::vector<storage::SequenceGap> StoredTelemetry::sequence_gaps() const {
  return archive_.sequence_gaps();
}

}  // namespace reident::history
