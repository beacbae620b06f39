#include <stdexcept>

#include "service/history/page_maker.hpp"
#include "service/history/row_values.hpp"
#include "service/history/subjects.hpp"
#include "storage/registry/registry.hpp"

namespace reident::history {
namespace {

using storage::EquipmentName;
using storage::Registry;

std::optional<storage::TimeRange> wanted_range(const HistoryQuery& query) {
  return query.range.begin == query.range.end ? std::nullopt : std::optional(query.range);
}

storage::RowFilter filter_of(const HistoryQuery& query, const PageMaker& maker) {
  storage::RowFilter filter;
  filter.spacecraft = query.spacecraft;
  filter.equipment = query.equipment;
  filter.range = wanted_range(query);
  if (query.version != 0) filter.version = query.version;
  filter.newest_first = query.newest_first;
  if (maker.beyond()) filter.beyond = maker.beyond()->at(0).get<std::int64_t>();
  return filter;
}

/// Adds the row of each selected equipment beyond the cursor. There are as many as the
/// configuration ever named.
template <typename MakeRow>
HistoryPage page_by_equipment(storage::Database& database, const HistoryQuery& query,
                              const MakeRow& make_row) {
  PageMaker maker(query);
  std::optional<EquipmentName> beyond;
  if (maker.beyond()) beyond = {read_text(maker.beyond()->at(0)), read_text(maker.beyond()->at(1))};
  const Registry registry(database);
  for (const EquipmentName& one : registry.equipment()) {
    if ((!query.spacecraft.empty() && one.spacecraft != query.spacecraft) ||
        (!query.equipment.empty() && one.equipment != query.equipment) ||
        (beyond && one <= *beyond))
      continue;
    if (!maker.add(make_row(registry, one),
                   Json::array({text_value(one.spacecraft), text_value(one.equipment)})))
      break;
  }
  return maker.page();
}

/// Adds rows that ascend by their begin, those of the range if one is asked for.
template <typename Row>
HistoryPage page_by_time(const HistoryQuery& query, const std::vector<Row>& rows,
                         storage::Time (*begin_of)(const Row&)) {
  PageMaker maker(query);
  const auto range = wanted_range(query);
  for (const Row& row : rows) {
    const storage::Time begin = begin_of(row);
    if (range && (begin < range->begin || begin >= range->end)) continue;
    if (!maker.add(row_of(row), Json::array({begin}))) break;
  }
  return maker.page();
}

/// Where rows that ascend by their begin go on.
storage::Time first_begin(const HistoryQuery& query) {
  const PageMaker maker(query);
  if (!maker.beyond()) return INT64_MIN;
  return maker.beyond()->at(0).get<std::int64_t>() + 1;
}

}  // namespace

HistoryPage equipment_page(storage::Database& database, const HistoryQuery& query) {
  return page_by_equipment(database, query, [](const Registry& registry, const auto& name) {
    return row_of(EquipmentRow{name, registry.hold(name.spacecraft, name.equipment)});
  });
}

HistoryPage champions_page(storage::Database& database, const HistoryQuery& query) {
  // At the last instant of the range; an end at the greatest time is in it.
  std::optional<storage::Time> time;
  if (const auto range = wanted_range(query))
    time = range->end == INT64_MAX ? range->end : range->end - 1;
  return page_by_equipment(database, query, [time](const Registry& registry, const auto& name) {
    return row_of(
        ChampionRow{name, registry.champion_decision(name.spacecraft, name.equipment, time)});
  });
}

HistoryPage attempts_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  Registry(database).each_attempt(filter_of(query, maker), [&](storage::Attempt&& attempt) {
    return maker.add(row_of(attempt), Json::array({attempt.id}));
  });
  return maker.page();
}

HistoryPage versions_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  Registry(database).each_version(filter_of(query, maker), [&](storage::Version&& version) {
    return maker.add(summary_row_of(version), Json::array({version.attempt}));
  });
  return maker.page();
}

HistoryPage models_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  Registry(database).each_version(filter_of(query, maker), [&](storage::Version&& version) {
    return maker.add(row_of(version), Json::array({version.attempt}));
  });
  return maker.page();
}

HistoryPage decisions_page(storage::Database& database, const HistoryQuery& query) {
  PageMaker maker(query);
  Registry(database).each_decision(filter_of(query, maker), [&](storage::Decision&& decision) {
    return maker.add(row_of(decision), Json::array({decision.id}));
  });
  return maker.page();
}

HistoryPage blocks_page(storage::Database& database, const HistoryQuery& query) {
  if (query.spacecraft.empty() || query.equipment.empty())
    throw std::invalid_argument("blocks are of one equipment; name it and its spacecraft");
  const auto blocks =
      Registry(database).blocks(query.spacecraft, query.equipment, first_begin(query));
  return page_by_time<storage::Block>(
      query, blocks, [](const storage::Block& block) { return block.range.begin; });
}

HistoryPage scores_page(storage::Database& database, const HistoryQuery& query) {
  if (query.spacecraft.empty() || query.equipment.empty() || query.version == 0)
    throw std::invalid_argument(
        "scores are of one version; name it, its equipment and its spacecraft");
  const auto scores = Registry(database).scores(query.spacecraft, query.equipment, query.version,
                                                first_begin(query));
  return page_by_time<storage::BlockScore>(
      query, scores, [](const storage::BlockScore& score) { return score.begin; });
}

}  // namespace reident::history
