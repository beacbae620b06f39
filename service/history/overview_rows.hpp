// How the models of all equipment are now: the rows that the console, the page and programs show.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "service/history/rows.hpp"
#include "service/model/messages.hpp"

namespace reident::history {

/// One equipment. Errors are MRSE of free runs, in percent; absent where they are not known.
struct OverviewRow {
  storage::EquipmentName name;
  std::int64_t champion = 0;  // 0: none
  storage::Time since = 0;    // when it became champion
  /// On the last two operating cycles of the champion's record, and on what approved it.
  std::optional<double> error_percent, approved_error_percent;
  /// The error of the simulator's own model, on the same last cycles.
  std::optional<double> simulator_percent;
  /// The last change of the equipment, where the champion's record shows it.
  std::optional<storage::FoundChange> change;
  std::vector<std::int64_t> waiting;  // versions that wait for an operator
  std::optional<storage::Hold> hold;
  /// Generation time until which every parameter of the champion has telemetry.
  std::optional<storage::Time> telemetry;
  /// Simulators that run a model of the equipment, and those of them that run the champion.
  std::int64_t simulators = 0, current = 0;
  std::int64_t attempts = 0, versions = 0, approvals = 0;  // how many there were
};

/// A version that waits for an operator.
struct WaitingRow {
  storage::Decision decision;  // the last about it: since when and why it waits
  storage::TimeRange window;
  /// Versions that wait too, and that its approval answers.
  std::vector<std::int64_t> supersedes;
};

Json row_of(const OverviewRow& row);
Json row_of(const WaitingRow& row);
Json row_of(const storage::Alarm& alarm);
Json row_of(const storage::SimulatorState& state);
void read_row(const Json& row, OverviewRow& overview);
void read_row(const Json& row, WaitingRow& waiting);
void read_row(const Json& row, storage::Alarm& alarm);
void read_row(const Json& row, storage::SimulatorState& state);

/// Whether somebody has to act: an alarm about the equipment that nobody has seen yet, or a version
/// that waits.
bool needs_action(const OverviewRow& row, const std::vector<storage::Alarm>& alarms);

/// Adds a row of an equipment that no window was tried of, where it has none.
void add_untried(const storage::EquipmentName& name, std::vector<OverviewRow>& rows);

/// The alarm of a configured database that no service has open.
storage::Alarm no_service_alarm(const std::filesystem::path& database, storage::Time now);

/// Adds the alarm of a disk with next to no room left, unless there is one of its code: a full disk
/// records none.
void add_full_disk(const std::filesystem::path& database, storage::Time now,
                   std::vector<storage::Alarm>& alarms);

/// Adds the alarms of those that are of a pair and do not lead it: the database has none of them.
void add_alarms_of(const std::vector<ServiceStatus>& services, std::vector<storage::Alarm>& alarms);

/// Orders by what needs an operator most: a champion that fails, other alarms, versions that wait,
/// no champion; then by how much the error has grown since the approval.
void put_worst_first(std::vector<OverviewRow>& rows, const std::vector<storage::Alarm>& alarms);

}  // namespace reident::history
