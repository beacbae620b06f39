// How the models of all equipment are now, from a database. Every answer is of bounded cost: it
// does not grow with the length of the records.
#pragma once

#include <vector>

#include "service/history/overview_rows.hpp"
#include "storage/database/database.hpp"
#include "storage/registry/registry.hpp"

namespace reident::history {

/// The equipment with attempts, by name. Throws storage::Error.
std::vector<OverviewRow> overview(storage::Database& database);

/// The versions that wait for an operator, by equipment and number. Throws storage::Error.
std::vector<WaitingRow> waiting(const storage::Registry& registry);

}  // namespace reident::history
