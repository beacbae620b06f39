// What the events of a life do to the platform's constants.
#pragma once

#include <span>

#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/reference/reference_life.hpp"

namespace reident::satcs::platform {

/// The constants at `time` of a platform that was launched with `fresh`. Events of the power
/// subsystem change nothing.
Constants aged(const Constants& fresh, std::span<const reference::LifeEvent> life,
               storage::Time time);

}  // namespace reident::satcs::platform
