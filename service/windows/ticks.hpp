// Which ticks suit the times of samples: how far apart, and how far behind the multiples of that.
// Times are in ns; those of one channel ascend. Nothing here throws but std::bad_alloc.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// Returns the step of times: the median, or where they are rounded or jitter about a grid, the
/// roundest period of a grid that goes with all of them. Requires steps, and none below 1.
std::int64_t usual_step(std::span<const std::int64_t> steps_ns);

/// Returns how far behind the multiples of the period ticks have to stand so that the values at a
/// tick belong together: in the widest stretch of a period in which no channel speaks. 0 where the
/// multiples do, or no place is better. The first 1000 periods in which all channels speak decide.
std::int64_t suitable_phase(const std::vector<std::vector<std::int64_t>>& channels_ns,
                            std::int64_t period_ns);

/// Returns the equipment with the phase of its ticks: the configured one; else that of its newest
/// version, where this was made of the same telemetry; else what suits its first telemetry. So the
/// phase stays as it is from the first version on. Damaged samples count as none. Throws
/// storage::Error where the file cannot be read.
EquipmentConfig with_phase(EquipmentConfig equipment, const std::string& spacecraft,
                           const storage::Archive& archive, const storage::Registry& registry);

/// Where the configuration says no phase, and the newest telemetry before `end` suits another than
/// with_phase() gives: one sentence with the key that mends it. Throws as that does.
std::optional<std::string> advised_phase(const storage::Archive& archive,
                                         const storage::Registry& registry,
                                         const std::string& spacecraft,
                                         const EquipmentConfig& equipment, storage::Time end);

}  // namespace reident
