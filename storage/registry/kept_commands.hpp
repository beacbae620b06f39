// What operators ordered, as the service answered it.
#pragma once

#include <vector>

#include "storage/database/database.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident::storage {

/// A command that was carried out or refused.
struct KeptCommand {
  Command command;
  Time time = 0;
  CommandOutcome outcome;
};

/// The newest `most` commands of the times in `range`, the newest first. Throws Error where the
/// file cannot be read.
std::vector<KeptCommand> kept_commands(const Database& database, TimeRange range, std::size_t most);

}  // namespace reident::storage
