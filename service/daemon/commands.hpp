// What an operator may order about an equipment's versions, and the answer to each order.
//
// service/DESIGN.md has the table of actions. The daemon executes commands on its writer's thread;
// the command line executes them on the file while no daemon holds it.
#pragma once

#include <vector>

#include "service/daemon/config.hpp"
#include "storage/registry.hpp"

namespace reident {

/// Decides and records in one transaction. The outcome is one sentence: what was done, or why
/// nothing was and what would mend it. A command that was executed before gets the outcome that it
/// got then. A command that names no spacecraft means the only one that has the equipment.
/// `configured` are known beside the equipment that the registry has. Throws storage::Error.
storage::CommandOutcome execute(const storage::Command& command, storage::Registry& registry,
                                const std::vector<storage::EquipmentName>& configured,
                                storage::Time now);

/// The equipment of a configuration.
std::vector<storage::EquipmentName> equipment_of(const Config& config);

}  // namespace reident
