#include "service/history/remote_readers.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace reident::history {
namespace {

using storage::EquipmentName;

HistoryQuery about(const char* subject, const EquipmentName& equipment = {},
                   std::optional<std::int64_t> version = std::nullopt) {
  HistoryQuery query;
  query.subject = subject;
  query.spacecraft = equipment.spacecraft;
  query.equipment = equipment.equipment;
  query.version = version.value_or(0);
  return query;
}

HistoryQuery samples_of(const std::string& spacecraft, storage::Origin origin,
                        std::uint32_t parameter, storage::TimeRange range) {
  HistoryQuery query = about("samples", {spacecraft, ""});
  query.origin = origin;
  query.parameter = parameter;
  query.range = range;
  return query;
}

/// Samples page by page.
class Pages final : public SampleBatches {
 public:
  Pages(const RemoteRows& rows, HistoryQuery query) : rows_(rows), query_(std::move(query)) {}

  bool next(storage::SampleColumns& batch) override {
    batch = {};
    while (!at_end_ && batch.empty()) {
      HistoryPage page = rows_.page(query_);
      for (const std::string& text : page.rows) {
        const auto row = RemoteRows::read<storage::SampleColumns>(text);
        batch.append(row, 0, row.size());
      }
      query_.cursor = std::move(page.next_cursor);
      at_end_ = query_.cursor.empty();
    }
    return !batch.empty();
  }

 private:
  const RemoteRows rows_;
  HistoryQuery query_;
  bool at_end_ = false;
};

}  // namespace

HistoryPage RemoteRows::page(const HistoryQuery& query) const {
  auto answer = history_.page(query, timeout_);
  if (const auto* failure = std::get_if<RemoteHistory::Failure>(&answer))
    throw Error(failure->kind, failure->message);
  return std::get<HistoryPage>(std::move(answer));
}

void RemoteRows::refuse_row(const std::exception& mistake) {
  throw Error(Error::Kind::refused,
              std::string("the service sent a row that this program does not understand (") +
                  mistake.what() + "); bring both to the same version");
}

std::vector<EquipmentName> RemoteHistoryReader::equipment() const {
  std::vector<EquipmentName> names;
  for (EquipmentRow& row : rows_.all<EquipmentRow>(about("equipment")))
    names.push_back(std::move(row.name));
  return names;
}

std::optional<storage::Hold> RemoteHistoryReader::hold(const EquipmentName& equipment) const {
  auto row = rows_.first<EquipmentRow>(about("equipment", equipment));
  return row ? std::move(row->hold) : std::nullopt;
}

std::vector<storage::Attempt> RemoteHistoryReader::attempts(
    const storage::HistoryFilter& filter) const {
  HistoryQuery query = about("attempts", {filter.spacecraft, filter.equipment});
  if (filter.window) query.range = *filter.window;
  query.newest_first = filter.last.has_value();
  std::vector<storage::Attempt> attempts;
  if (filter.last == std::size_t{0}) return attempts;
  rows_.each<storage::Attempt>(query, [&](storage::Attempt&& attempt) {
    if (!filter.versions_only || attempt.version) attempts.push_back(std::move(attempt));
    return !filter.last || attempts.size() < *filter.last;
  });
  if (query.newest_first) std::reverse(attempts.begin(), attempts.end());
  return attempts;
}

std::optional<storage::Attempt> RemoteHistoryReader::attempt(const EquipmentName& equipment,
                                                             std::int64_t version) const {
  return rows_.first<storage::Attempt>(about("attempts", equipment, version));
}

std::vector<storage::VersionSummary> RemoteHistoryReader::summaries(
    const EquipmentName& equipment) const {
  std::vector<storage::VersionSummary> summaries;
  for (storage::Version& version : rows_.all<storage::Version>(about("versions", equipment)))
    summaries.push_back({version.number, std::move(version.status), version.parent});
  return summaries;
}

std::optional<storage::Version> RemoteHistoryReader::version(const EquipmentName& equipment,
                                                             std::int64_t number) const {
  if (number == 0) return std::nullopt;  // it would select every one
  return rows_.first<storage::Version>(about("model", equipment, number));
}

std::vector<storage::Decision> RemoteHistoryReader::decisions(
    const EquipmentName& equipment, std::optional<std::int64_t> version) const {
  return rows_.all<storage::Decision>(about("decisions", equipment, version));
}

std::optional<storage::Decision> RemoteHistoryReader::champion_decision(
    const EquipmentName& equipment, std::optional<storage::Time> time) const {
  HistoryQuery query = about("champion", equipment);
  if (time)
    query.range = {*time == INT64_MAX ? *time - 1 : *time, *time == INT64_MAX ? *time : *time + 1};
  auto row = rows_.first<ChampionRow>(query);
  return row ? std::move(row->decision) : std::nullopt;
}

std::vector<OverviewRow> RemoteHistoryReader::overview() const {
  return rows_.all<OverviewRow>(about("overview"));
}

std::vector<WaitingRow> RemoteHistoryReader::waiting() const {
  return rows_.all<WaitingRow>(about("waiting"));
}

std::vector<storage::Alarm> RemoteHistoryReader::alarms() const {
  return rows_.all<storage::Alarm>(about("alarms"));
}

std::vector<storage::SimulatorState> RemoteHistoryReader::simulators() const {
  return rows_.all<storage::SimulatorState>(about("simulators"));
}

std::vector<storage::Block> RemoteHistoryReader::blocks(const EquipmentName& equipment) const {
  return rows_.all<storage::Block>(about("blocks", equipment));
}

std::vector<storage::BlockScore> RemoteHistoryReader::scores(const EquipmentName& equipment,
                                                             std::int64_t version) const {
  return rows_.all<storage::BlockScore>(about("scores", equipment, version));
}

std::optional<storage::ParameterDescriptor> RemoteTelemetryReader::parameter(
    const std::string& spacecraft, const std::string& name) const {
  std::optional<storage::ParameterDescriptor> found;
  rows_.each<storage::ParameterDescriptor>(about("parameters", {spacecraft, ""}),
                                           [&](storage::ParameterDescriptor&& one) {
                                             if (one.name == name) found = std::move(one);
                                             return !found.has_value();
                                           });
  return found;
}

storage::Series RemoteTelemetryReader::read(const std::string& spacecraft, storage::Origin origin,
                                            std::uint32_t parameter,
                                            storage::TimeRange range) const {
  storage::Series series;
  if (range.begin >= range.end) return series;
  Pages pages(rows_, samples_of(spacecraft, origin, parameter, range));
  storage::SampleColumns batch;
  while (pages.next(batch)) {
    series.time.insert(series.time.end(), batch.time.begin(), batch.time.end());
    series.value.insert(series.value.end(), batch.value.begin(), batch.value.end());
    series.quality.insert(series.quality.end(), batch.quality.begin(), batch.quality.end());
  }
  return series;
}

std::vector<storage::SeriesInfo> RemoteTelemetryReader::series() const {
  auto all = rows_.all<storage::SeriesInfo>(about("series"));
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.spacecraft, a.origin, a.name, a.parameter) <
           std::tie(b.spacecraft, b.origin, b.name, b.parameter);
  });
  return all;
}

std::map<std::int64_t, std::string> RemoteTelemetryReader::source_names() const {
  std::map<std::int64_t, std::string> names;
  for (auto& source : rows_.all<std::pair<std::int64_t, std::string>>(about("sources")))
    names.insert(std::move(source));
  return names;
}

std::unique_ptr<SampleBatches> RemoteTelemetryReader::batches(
    const storage::SeriesInfo& series, storage::TimeRange range, std::size_t /*chunks*/,
    storage::WantedColumns /*wanted*/) const {
  return std::make_unique<Pages>(
      rows_, samples_of(series.spacecraft, series.origin, series.parameter, range));
}

std::vector<storage::BinCounts> RemoteTelemetryReader::completeness(
    const storage::SeriesInfo& series, const storage::TimeBins& bins, storage::Time until) const {
  HistoryQuery query = samples_of(series.spacecraft, series.origin, series.parameter, bins.range());
  query.subject = "completeness";
  query.step = bins.length();
  query.until = until;
  std::vector<storage::BinCounts> counts(bins.count());
  rows_.each<CountsRow>(query, [&](CountsRow&& row) {
    for (std::size_t i = 0; i < row.counts.size() && row.first + i < counts.size(); ++i)
      counts[row.first + i] = row.counts[i];
    return true;
  });
  return counts;
}

std::vector<storage::SequenceGap> RemoteTelemetryReader::sequence_gaps() const {
  return rows_.all<storage::SequenceGap>(about("sequence_gaps"));
}

}  // namespace reident::history
