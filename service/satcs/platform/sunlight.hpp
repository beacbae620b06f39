// What the panels take up from the Sun and the Earth, by the place in the orbit.
//
// The spacecraft looks at the Earth all the time. The Sun's direction in its frame is
//   zenith = cos(beta) cos(u),  sun side = sin(beta),       u: from the orbit's noon
// Slews are short, and are left out here.
#pragma once

#include <array>

#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/reference/reference_orbit.hpp"

namespace reident::satcs::platform {

using PanelValues = std::array<double, panel_count>;

struct Sunlight {
  double illumination = 0;  // the share of the Sun's disc that is seen
  double flux = 0;          // direct, over that at 1 AU; 0 in eclipse
  PanelValues direct{};     // flux on each panel, over that at 1 AU
  double reflected = 0;     // by the Earth on a panel that looks at it, over the flux at 1 AU
};

Sunlight sunlight_at(const reference::Orbit& orbit, const EnvironmentConstants& constants,
                     storage::Time time);

/// Sunlight, reflected sunlight and the Earth's infrared [W].
PanelValues absorbed_W(const Sunlight& sunlight, const EnvironmentConstants& environment,
                       const ThermalConstants& thermal);

}  // namespace reident::satcs::platform
