// One attempt at a window: prepare a candidate, and decide whether it becomes a challenger.
//
// Reads the archive and the registry; writes nothing.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "service/judgement/gate.hpp"
#include "service/windows/candidate.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// What is to be recorded of a window.
struct RefreshResult {
  storage::NewAttempt attempt;                   // its time is left to whoever records it
  std::optional<EquipmentModel> candidate;       // absent where the window gave no model
  storage::NewVersion version;                   // of the candidate
  std::optional<storage::NewDecision> decision;  // present with a candidate
  Evidence evidence;                             // meaningful with a candidate
  /// Of the champion on the same rows; not a number where it has no run there.
  double champion_mrse_percent = std::numeric_limits<double>::quiet_NaN();
};

/// The window without what lies before the champion's. That one begins later where it was asked for
/// because an older champion drifted: telemetry of before is of what the equipment was then.
storage::TimeRange behind_champion(const storage::Registry& registry, const std::string& spacecraft,
                                   const std::string& equipment, storage::TimeRange window);

/// Chooses among the candidate, the champion adapted to the window and a static gain, and decides
/// on the chosen one. The champion is that of the registry now: whoever records checks that it
/// still is. Throws storage::Error but for damaged telemetry, which is an outcome.
RefreshResult judge(const storage::Registry& registry, const RefreshRequest& request,
                    PreparedWindow&& prepared);

/// prepare_window, then judge; throws as these do.
RefreshResult refresh(const storage::Archive& archive, const storage::Registry& registry,
                      const RefreshRequest& request, WindowCache& kept,
                      const identification::ForEach& for_each, const std::function<bool()>& stop);

}  // namespace reident
