// The plant of a life from its start to where the last versions can be judged: the frames that the
// ground may hear, and what nobody but the score knows.
#pragma once

#include <functional>
#include <vector>

#include "tests/trust/known_series.hpp"
#include "tests/trust/scenario.hpp"

namespace reident::trust {

Duration orbit_ns();

/// The telemetry, and after it the orbits that the last versions are judged on.
storage::TimeRange extent_of(const LifeGroup& group);

/// Descriptors of what the equipment of `spacecraft` names.
std::vector<storage::ParameterDescriptor> telemetry_of(const SpacecraftConfig& spacecraft);

/// What is known of a life in addition to what the services hear.
struct Known {
  KnownSeries truth;      // of perfect sensors
  KnownSeries clean;      // without faults
  KnownSeries simulated;  // of the hand-written simulator
};

/// A frame of the spacecraft, and the simulator's of the same time.
using Heard = std::function<void(const storage::TelemetryFrame& frame,
                                 const storage::TelemetryFrame& simulated)>;

/// Goes through the whole life second by second. Each sample period of the equipment has a frame,
/// with the last sample of each of its parameters that was due since the one before; `heard` gets
/// those of the telemetry.
Known fly(const LifeGroup& group, const SpacecraftConfig& spacecraft, const Heard& heard);

}  // namespace reident::trust
