// Telemetry that retention must leave.
#pragma once

#include <vector>

#include "service/config/config.hpp"
#include "storage/archive/archive.hpp"
#include "storage/care/retention.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// What every version that was ever published (approved, or rolled back to; also those withdrawn
/// since) was identified from, tuned and validated on: the parameters of its inputs and outputs,
/// simulated ones too, in its window and the sample hold before that. Every parameter of the
/// spacecraft is protected where the model cannot be read, or where no descriptor has the name of
/// one of its parameters any more. Throws storage::Error.
std::vector<storage::ProtectedRange> telemetry_of_versions(const storage::Archive& archive,
                                                           const storage::Registry& registry);

/// What the service will still read of each equipment, so that a rule that is too tight does not
/// take it away: what the next window and the next block are read from (the last window and slide
/// before where the spacecraft's telemetry, or the clock, ends). Spacecraft without telemetry have
/// none. Throws storage::Error.
std::vector<storage::ProtectedRange> telemetry_still_needed(const storage::Archive& archive,
                                                            const Config& config,
                                                            storage::Time now);

}  // namespace reident
