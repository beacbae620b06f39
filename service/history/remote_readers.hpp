// The readers of a running service's history. Each throws Error where no answer comes, and
// dds::Error where the middleware fails. What a call asks for may take several pages: rows that are
// added meanwhile may be among them, and a row comes once. One thread at a time, also for all that
// share a RemoteHistory.
#pragma once

#include <functional>

#include "service/history/readers.hpp"
#include "service/history/remote_history.hpp"
#include "service/history/rows.hpp"

namespace reident::history {

/// Every row of a question, page after page. Copies share the RemoteHistory, which has to outlive
/// them.
class RemoteRows {
 public:
  /// Each page may take `timeout`.
  RemoteRows(RemoteHistory& history, std::chrono::milliseconds timeout)
      : history_(history), timeout_(timeout) {}

  /// Asks for the rows beyond the query's cursor. Throws Error.
  HistoryPage page(const HistoryQuery& query) const;

  /// Calls `visit` with each row until it answers false. Throws Error, also for a row that is not
  /// of its kind.
  template <typename Row>
  void each(HistoryQuery query, const std::function<bool(Row&&)>& visit) const {
    do {
      HistoryPage page = this->page(query);
      for (const std::string& text : page.rows)
        if (!visit(read<Row>(text))) return;
      query.cursor = std::move(page.next_cursor);
    } while (!query.cursor.empty());
  }

  /// Returns every row; all of them are in memory at once. Throws as each().
  template <typename Row>
  std::vector<Row> all(const HistoryQuery& query) const {
    std::vector<Row> rows;
    each<Row>(query, [&rows](Row&& row) {
      rows.push_back(std::move(row));
      return true;
    });
    return rows;
  }

  /// Returns the first row; absent where there is none. A whole page is sent for it. Throws as
  /// each().
  template <typename Row>
  std::optional<Row> first(const HistoryQuery& query) const {
    std::optional<Row> found;
    each<Row>(query, [&found](Row&& row) {
      found = std::move(row);
      return false;
    });
    return found;
  }

  /// Returns the row that a page has as text. Throws Error for one that is not of its kind.
  template <typename Row>
  static Row read(const std::string& text) {
    Row row{};
    try {
      read_row(Json::parse(text), row);
    } catch (const std::exception& mistake) {
      refuse_row(mistake);
    }
    return row;
  }

 private:
  [[noreturn]] static void refuse_row(const std::exception& mistake);

  RemoteHistory& history_;
  const std::chrono::milliseconds timeout_;
};

/// What was tried and decided, as the service's registry has it.
class RemoteHistoryReader final : public HistoryReader {
 public:
  explicit RemoteHistoryReader(const RemoteRows& rows) : rows_(rows) {}

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
  const RemoteRows rows_;
};

/// What was archived, as the service's database has it. Chunks are decoded by the service, samples
/// are columns on the way.
class RemoteTelemetryReader final : public TelemetryReader {
 public:
  explicit RemoteTelemetryReader(const RemoteRows& rows) : rows_(rows) {}

  std::optional<storage::ParameterDescriptor> parameter(const std::string& spacecraft,
                                                        const std::string& name) const override;
  /// Without the ids of sources.
  storage::Series read(const std::string& spacecraft, storage::Origin origin,
                       std::uint32_t parameter, storage::TimeRange range) const override;
  std::vector<storage::SeriesInfo> series() const override;
  std::map<std::int64_t, std::string> source_names() const override;
  /// A batch is a page with all columns, whatever `chunks` and `wanted` say.
  std::unique_ptr<SampleBatches> batches(const storage::SeriesInfo& series,
                                         storage::TimeRange range, std::size_t chunks,
                                         storage::WantedColumns wanted) const override;
  std::vector<storage::BinCounts> completeness(const storage::SeriesInfo& series,
                                               const storage::TimeBins& bins,
                                               storage::Time until) const override;
  std::vector<storage::SequenceGap> sequence_gaps() const override;

 private:
  const RemoteRows rows_;
};

}  // namespace reident::history
