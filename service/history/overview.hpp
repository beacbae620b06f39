// How the models of all equipment are now, from a database. Every answer is of bounded cost: it
// does not grow with the length of the records.
#pragma once

#include <optional>
#include <vector>

#include "service/history/overview_rows.hpp"
#include "storage/database/database.hpp"
#include "storage/registry/registry.hpp"

namespace reident::history {

/// The equipment with attempts, by name. Throws storage::Error.
std::vector<OverviewRow> overview(storage::Database& database);

/// What the version erred on the telemetry that spoke for it when `made` made it champion: by this
/// decision, or where an operator made it, by the gate's last one before; without any on its
/// validation part. Absent where that is not known. Throws storage::Error.
std::optional<double> error_when_approved(const storage::Registry& registry,
                                          const storage::Decision& made);

/// The versions that wait for an operator, by equipment and number. Throws storage::Error.
std::vector<WaitingRow> waiting(const storage::Registry& registry);

}  // namespace reident::history
