#include "service/satcs/platform/sunlight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reident::satcs::platform {

Sunlight sunlight_at(const reference::Orbit& orbit, const EnvironmentConstants& constants,
                     storage::Time time) {
  const double beta = orbit.beta(time);
  const double from_noon =
      2 * std::numbers::pi * (orbit.count(time).phase - orbit.noon_phase(time));
  const double zenith = std::cos(beta) * std::cos(from_noon);
  Sunlight s;
  s.illumination = orbit.illumination(time);
  s.flux = s.illumination * orbit.relative_flux(time);
  s.direct[zenith_panel] = s.flux * std::max(zenith, 0.0);
  s.direct[nadir_panel] = s.flux * std::max(-zenith, 0.0);
  s.direct[sun_panel] = s.flux * std::abs(std::sin(beta));
  // The ground below is lit as the zenith panel is, whether or not the Earth hides the Sun.
  s.reflected = constants.albedo * orbit.relative_flux(time) * std::max(zenith, 0.0);
  return s;
}

PanelValues absorbed_W(const Sunlight& sunlight, const EnvironmentConstants& environment,
                       const ThermalConstants& thermal) {
  PanelValues absorbed{};
  for (std::size_t p = 0; p < panel_count; ++p) {
    const PanelConstants& panel = thermal.panel[p];
    const double sun = sunlight.direct[p] + panel.earth_view * sunlight.reflected;
    absorbed[p] =
        panel.area_m2 * (panel.absorptance * environment.solar_flux_W_m2 * sun +
                         panel.emittance * panel.earth_view * environment.earth_infrared_W_m2);
  }
  return absorbed;
}

}  // namespace reident::satcs::platform
