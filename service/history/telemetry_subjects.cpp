#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "service/history/page_maker.hpp"
#include "service/history/subjects.hpp"
#include "storage/archive/archive.hpp"
#include "storage/archive/holdings.hpp"
#include "storage/care/completeness.hpp"

namespace reident::history {
namespace {

using storage::Time;

// Small compared with a page, so that pages are well filled.
constexpr std::size_t samples_of_row = 512;
constexpr std::size_t bins_of_row = 512;
constexpr std::size_t max_bins = 100'000;

constexpr storage::TimeRange all_of_time{std::numeric_limits<Time>::min(),
                                         std::numeric_limits<Time>::max()};

storage::TimeRange range_of(const HistoryQuery& query) {
  return query.range.begin == query.range.end ? all_of_time : query.range;
}

bool lies_in(Time time, const storage::TimeRange& range) {
  return range.begin <= time && (time < range.end || range.end == all_of_time.end);
}

bool is_selected(const HistoryQuery& query, const std::string& spacecraft) {
  return query.spacecraft.empty() || query.spacecraft == spacecraft;
}

std::int64_t id_beyond(const PageMaker& maker) {
  return maker.beyond() ? maker.beyond()->at(0).get<std::int64_t>()
                        : std::numeric_limits<std::int64_t>::min();
}

std::optional<storage::SeriesInfo> series_asked_for(storage::Database& database,
                                                    const HistoryQuery& query) {
  if (query.spacecraft.empty())
    throw std::invalid_argument(
        fmt::format("{} are of one series; name its spacecraft, origin and parameter (the subject "
                    "'series' lists them)",
                    query.subject));
  const auto id = storage::series_id(database, query.spacecraft, query.origin, query.parameter);
  if (!id) return std::nullopt;
  storage::SeriesInfo series;
  series.id = *id;
  series.spacecraft = query.spacecraft;
  series.origin = query.origin;
  series.parameter = query.parameter;
  return series;
}

}  // namespace

HistoryPage parameters_page(storage::Database& database, const HistoryQuery& query) {
  if (query.spacecraft.empty())
    throw std::invalid_argument("parameters are of one spacecraft; name it");
  PageMaker maker(query);
  for (const auto& parameter : storage::Archive(database).parameters(query.spacecraft))
    if (parameter.id > id_beyond(maker) &&
        !maker.add(row_of(parameter), Json::array({parameter.id})))
      break;
  return maker.page();
}

HistoryPage series_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  std::vector<storage::SeriesInfo> all = storage::all_series(database);
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  for (const storage::SeriesInfo& series : all)
    if (series.id > id_beyond(maker) && is_selected(query, series.spacecraft) &&
        !maker.add(row_of(series), Json::array({series.id})))
      break;
  return maker.page();
}

HistoryPage sources_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  for (const auto& source : storage::source_names(database))
    if (source.first > id_beyond(maker) && !maker.add(row_of(source), Json::array({source.first})))
      break;
  return maker.page();
}

HistoryPage sequence_gaps_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  std::optional<storage::GapKey> beyond;
  if (maker.beyond()) {
    const auto at = [&](std::size_t i) { return maker.beyond()->at(i).get<std::int64_t>(); };
    beyond = {at(0), at(1), at(2)};
  }
  const storage::TimeRange range = range_of(query);
  storage::each_sequence_gap(
      database, beyond, [&](const storage::GapKey& key, storage::SequenceGap&& gap) {
        if (!is_selected(query, gap.spacecraft) || !lies_in(gap.before, range)) return true;
        return maker.add(row_of(gap), Json::array({key.source, key.run, key.first}));
      });
  return maker.page();
}

// A page ends in the middle of a chunk; the next one reads that chunk again.
HistoryPage samples_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  const auto series = series_asked_for(database, query);
  storage::TimeRange range = range_of(query);
  if (maker.beyond()) {
    const Time last = id_beyond(maker);
    if (last == std::numeric_limits<Time>::max()) return maker.page();
    range.begin = last + 1;
  }
  if (!series || range.begin >= range.end) return maker.page();
  storage::SeriesBatches batches(database, series->id, range, 1, {});
  storage::SampleColumns samples;
  while (batches.next(samples))
    for (std::size_t first = 0; first < samples.size(); first += samples_of_row) {
      const std::size_t last = std::min(first + samples_of_row, samples.size());
      if (!maker.add(row_of(samples, first, last), Json::array({samples.time[last - 1]})))
        return maker.page();
    }
  return maker.page();
}

HistoryPage completeness_page(storage::Database& database, const HistoryQuery& query) {
  if (query.step <= 0 || query.range.begin >= query.range.end)
    throw std::invalid_argument(
        "completeness is counted in bins; give step_ns above 0 and begin_ns before end_ns");
  const double count =
      (static_cast<double>(query.range.end) - static_cast<double>(query.range.begin)) /
      static_cast<double>(query.step);
  if (count > static_cast<double>(max_bins))
    throw std::invalid_argument(
        fmt::format("{:.0f} bins are too many; ask for at most {}", count, max_bins));
  PageMaker maker(query);
  const storage::TimeBins bins(query.range, query.step);
  std::vector<storage::BinCounts> counts(bins.count());
  if (const auto series = series_asked_for(database, query))
    counts = storage::completeness(database, *series, bins, query.until);
  const auto next = maker.beyond() ? maker.beyond()->at(0).get<std::size_t>() : std::size_t{0};
  for (std::size_t first = next; first < counts.size(); first += bins_of_row) {
    const std::size_t last = std::min(first + bins_of_row, counts.size());
    const auto begin = counts.begin() + static_cast<std::ptrdiff_t>(first);
    CountsRow row{first, {begin, counts.begin() + static_cast<std::ptrdiff_t>(last)}};
    if (!maker.add(row_of(row), Json::array({last}))) break;
  }
  return maker.page();
}

}  // namespace reident::history
