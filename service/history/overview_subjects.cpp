#include "service/history/overview.hpp"
#include "service/history/page_maker.hpp"
#include "service/history/row_values.hpp"
#include "service/history/subjects.hpp"

namespace reident::history {
namespace {

using storage::EquipmentName;

/// Adds the rows, which ascend by their keys, of the equipment that is asked for.
template <typename Row, typename NameOf, typename KeyOf>
HistoryPage page_of(const HistoryQuery& query, const std::vector<Row>& rows, const NameOf& name_of,
                    const KeyOf& key_of) {
  PageMaker maker(query);
  for (const Row& row : rows) {
    const EquipmentName name = name_of(row);
    if ((!query.spacecraft.empty() && name.spacecraft != query.spacecraft) ||
        (!query.equipment.empty() && name.equipment != query.equipment))
      continue;
    const auto key = key_of(row, name);
    Json values = Json::array();
    for (const std::string& part : key) values.push_back(text_value(part));
    if (maker.beyond()) {
      std::vector<std::string> beyond;
      for (const Json& part : *maker.beyond()) beyond.push_back(read_text(part));
      if (key <= beyond) continue;
    }
    if (!maker.add(row_of(row), values)) break;
  }
  return maker.page();
}

using Key = std::vector<std::string>;

/// Ascends as text as the number does.
std::string sortable(std::int64_t number) {
  const std::string digits = std::to_string(number);
  return std::string(20 - digits.size(), '0') + digits;
}

}  // namespace

HistoryPage overview_page(storage::Database& database, const HistoryQuery& query) {
  return page_of(
      query, overview(database), [](const OverviewRow& row) { return row.name; },
      [](const OverviewRow&, const EquipmentName& name) {
        return Key{name.spacecraft, name.equipment};
      });
}

HistoryPage waiting_page(storage::Database& database, const HistoryQuery& query) {
  return page_of(
      query, waiting(storage::Registry(database)),
      [](const WaitingRow& row) {
        return EquipmentName{row.decision.spacecraft, row.decision.equipment};
      },
      [](const WaitingRow& row, const EquipmentName& name) {
        return Key{name.spacecraft, name.equipment, sortable(row.decision.version)};
      });
}

HistoryPage alarms_page(storage::Database& database, const HistoryQuery& query) {
  return page_of(
      query, storage::Registry(database).alarms(),
      [](const storage::Alarm& alarm) { return alarm.about; },
      [](const storage::Alarm& alarm, const EquipmentName& name) {
        return Key{alarm.code, name.spacecraft, name.equipment};
      });
}

HistoryPage simulators_page(storage::Database& database, const HistoryQuery& query) {
  return page_of(
      query, storage::Registry(database).simulators(),
      [](const storage::SimulatorState& state) { return state.equipment; },
      [](const storage::SimulatorState& state, const EquipmentName& name) {
        return Key{state.simulator, name.spacecraft, name.equipment};
      });
}

}  // namespace reident::history
