// Where the reference spacecraft is, how much of the Sun it sees, and which stations see it.
//
// A circular sun-synchronous orbit: the ascending node keeps its angle to the mean Sun. The Sun's
// declination goes through the year, and the beta angle with it. A spherical Earth without an
// atmosphere; the penumbra follows the part of the Sun's disc above the limb.
#pragma once

#include "service/satcs/reference/reference_constants.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// A function of time alone; any number of threads may ask.
class Orbit {
 public:
  explicit Orbit(const OrbitConstants& constants);

  /// The share of the Sun's disc that is seen, in [0, 1].
  double illumination(storage::Time time) const;
  /// Angle between the orbit's plane and the Sun [rad], positive on the side of the orbit's normal.
  double beta(storage::Time time) const;
  /// The solar flux outside the shadow over that at 1 AU: the seasons of the Sun's distance.
  double relative_flux(storage::Time time) const;
  /// Whether a ground station sees the spacecraft above the least elevation.
  bool in_contact(storage::Time time) const;

  /// Orbits since the reference instant, and the share of the running one that has passed.
  struct Count {
    std::int64_t number = 0;
    double phase = 0;  // [0, 1)
  };
  Count count(storage::Time time) const;
  /// The phase at which the spacecraft passes closest under the Sun.
  double noon_phase(storage::Time time) const;
  double period_s() const { return constants_.period_s; }

 private:
  struct Sun {
    double beta = 0;
    double argument = 0;  // of latitude of the Sun's projection into the orbit's plane [rad]
  };
  Sun sun(storage::Time time) const;

  OrbitConstants constants_;
  double node_angle_;  // of the ascending node, east of the mean Sun [rad]
  double sin_inclination_, cos_inclination_;
  double horizon_dip_;  // of the Earth's limb under the local horizontal [rad]
  double contact_cos_;  // of the largest Earth-central angle to a station in contact
};

}  // namespace reident::satcs::reference
