// Telemetry that retention must leave.
#pragma once

#include <vector>

#include "service/daemon/config.hpp"
#include "storage/archive.hpp"
#include "storage/registry.hpp"
#include "storage/retention.hpp"

namespace reident {

/// What every version that was ever published (approved, or rolled back to; also those withdrawn
/// since) was identified from, tuned and validated on: the parameters of its inputs and outputs,
/// simulated ones too, in its window and the hold before that. Of every parameter of the spacecraft
/// where the model cannot be read, or where no descriptor has the name of one of its parameters
/// any more.
std::vector<storage::ProtectedStretch> telemetry_of_versions(const storage::Archive& archive,
                                                             const storage::Registry& registry);

/// What versions on probation are judged by: the same, from where the runs may begin before the
/// window to the last look.
std::vector<storage::ProtectedStretch> telemetry_of_probations(const storage::Archive& archive,
                                                               const storage::Registry& registry,
                                                               const Config& config);

/// What the next window of each equipment is read from, so that a limit of size that is too low
/// does not take it away: the last window and slide before where the spacecraft's telemetry, or
/// the clock, ends.
std::vector<storage::ProtectedStretch> telemetry_of_next_windows(const storage::Archive& archive,
                                                                 const Config& config,
                                                                 storage::Time now);

}  // namespace reident
