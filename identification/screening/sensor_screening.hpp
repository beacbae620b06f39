// Sensors that do not follow the equipment for a while, found from their own samples: values that
// stand for none, stuck values, spikes, bursts of noise (METHOD.md, section 17). What is unusual is
// measured against the rest of the same rows and of the other channels. A fault other than a fill
// value that takes most of the rows is their usual state and is not found. Nothing here throws.
#pragma once

#include <string_view>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Rules, each with a condition on the other channels, are in METHOD.md.
enum class SensorFaultKind { fill, stuck, spike, noise };
/// Returns "fill", "stuck", "spike" or "noise".
std::string_view name(SensorFaultKind kind);

/// One fault of one channel.
struct SensorFault {
  SensorFaultKind kind = SensorFaultKind::stuck;
  Index channel = 0;  // inputs first, then outputs
  TickRange ticks;
};

/// Judges the channels that are `analog` (m + p entries, inputs first). Others repeat and jump by
/// nature: of them only fill values are found. Requires finite rows. Returns the faults by channel,
/// then kind, then time. The cost is linear in the rows.
std::vector<SensorFault> sensor_faults(const Record& record, const std::vector<bool>& analog);

}  // namespace reident::identification
