// The reference spacecraft's platform and its telemetry, a frame a second.
//
// Equal constants, life, start and seed give equal telemetry to the last bit.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "service/satcs/platform/platform_plant.hpp"
#include "service/satcs/platform/platform_telemetry.hpp"
#include "service/satcs/reference/sensed_plant.hpp"

namespace reident::satcs::platform {

class PlatformSpacecraft : public reference::SensedPlant<PlatformPlant> {
 public:
  /// The first reading is of `start`, rounded down to a second. `life` happens to a platform of
  /// the constants `fresh`; every event must be without life_mistake().
  PlatformSpacecraft(const Constants& fresh, std::vector<reference::LifeEvent> life,
                     storage::Time start, std::uint64_t seed)
      : SensedPlant(PlatformPlant(fresh, std::move(life), reference::whole_seconds(start), seed),
                    telemetry_points(), seed) {}
};

}  // namespace reident::satcs::platform
