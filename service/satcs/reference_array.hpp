// The solar array: its temperature and the current of a section at a voltage.
#pragma once

#include "service/satcs/reference_constants.hpp"

namespace reident::satcs::reference {

/// One wing of two-faced panels at one temperature.
class SolarArray {
 public:
  explicit SolarArray(const ArrayConstants& constants);
  void age(const ArrayConstants& constants) { constants_ = constants; }

  /// Current of one string [A] of `cells` in series that feeds a node at `node_V` through its
  /// blocking diode. Single exponential: I = I_sc (1 - exp((V - V_oc(T)) / V_knee)), never
  /// negative.
  double string_current(int cells, double node_V) const;

  /// `incidence` is the cosine of the Sun's angle to the panels, `illumination` lies in [0, 1].
  void set_sun(double illumination, double incidence) { flux_ = illumination * incidence; }
  /// The incidence at a beta angle [rad]: the wing follows the Sun in the orbit's plane.
  double incidence(double beta) const;
  void step(double dt_s);

  double temperature_C() const { return temperature_C_; }

 private:
  ArrayConstants constants_;
  double flux_ = 0;  // share of the solar flux at normal incidence
  double temperature_C_ = 20;
};

}  // namespace reident::satcs::reference
