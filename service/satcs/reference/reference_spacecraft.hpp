// The reference spacecraft: a CBERS-4-class electrical power subsystem and its telemetry, a frame a
// second.
//
// Equal constants, life, start and seed give equal telemetry to the last bit.
#pragma once

#include <cstdint>
#include <vector>

#include "service/satcs/reference/reference_plant.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"
#include "service/satcs/reference/sensed_plant.hpp"

namespace reident::satcs::reference {

/// Plant and sensors, second by second. One thread at a time.
class Spacecraft : public SensedPlant<Plant> {
 public:
  /// The first reading is of `start`, rounded down to a second. `life` happens to a spacecraft of
  /// the constants `fresh`; every event must be without life_mistake().
  Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
             std::uint64_t seed);
};

}  // namespace reident::satcs::reference
