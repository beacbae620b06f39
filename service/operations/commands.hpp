// What an operator may order about an equipment's versions, and the answer to each order.
//
// service/DESIGN.md has the table of actions. The daemon executes commands on its writer's thread;
// the command line executes them on the file while no daemon holds it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// What commands need in addition to the registry.
struct CommandContext {
  /// Equipment that is known in addition to that of the registry.
  std::vector<storage::EquipmentName> configured;
  /// Makes the window of an equipment due that ends where its telemetry ends, and returns that
  /// time; absent where no telemetry of it has come. Empty where no service runs.
  std::function<std::optional<storage::Time>(const storage::EquipmentName& equipment,
                                             const std::string& cause)>
      ask_for_window;
  /// Checks whether leadership of a pair can be given away. Empty where no service runs.
  std::function<storage::CommandOutcome(const storage::Command& command)> hand_over{};
};

/// Decides and records in one transaction. The outcome is one sentence: what was done, or why
/// nothing was and what would mend it. A command that was executed before gets the outcome that it
/// got then. A command that names no spacecraft means the only one that has the equipment.
/// Throws storage::Error.
storage::CommandOutcome execute(const storage::Command& command, storage::Registry& registry,
                                const CommandContext& context, storage::Time now);

/// The last decisions about the versions that wait for an operator rather than for telemetry, by
/// equipment and version. Throws storage::Error.
std::vector<storage::Decision> waiting_for_operator(const storage::Registry& registry);

/// Whether the approval of one such version answers the other: that is an earlier one of the same
/// equipment.
bool supersedes(const storage::Decision& approved, const storage::Decision& other);

/// Returns the equipment of a configuration, in its order.
std::vector<storage::EquipmentName> equipment_of(const Config& config);

/// Returns text such as "CBERS-4/BDR", as operators write it.
std::string full_name(const storage::EquipmentName& equipment);

/// " (why)", or nothing where no reason was given.
std::string reason_text(const std::string& reason);

/// "CBERS-4/BDR is held by Ana since 2026-11-21T15:00:00Z (why)".
std::string hold_text(const storage::EquipmentName& equipment, const storage::Hold& hold);

}  // namespace reident
