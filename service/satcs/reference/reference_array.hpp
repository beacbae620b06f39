// The solar array: its temperature and the current of a section at a voltage.
#pragma once

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// One wing of two-faced panels at one temperature.
class SolarArray {
 public:
  explicit SolarArray(const ArrayConstants& constants);
  /// Goes on with other constants; the temperature stays.
  void age(const ArrayConstants& constants) { constants_ = constants; }

  /// Current of one string [A] of `cells` in series that feeds a node at `node_V` through its
  /// blocking diode. Single exponential: I = I_sc (1 - exp((V - V_oc(T)) / V_knee)), never
  /// negative.
  double string_current(int cells, double node_V) const;

  /// `flux` of the solar flux at 1 AU reaches the panels, whose angle to it has the cosine
  /// `incidence`.
  void set_sun(double flux, double incidence) { flux_ = flux * incidence; }
  /// The incidence at a beta angle [rad]: the wing follows the Sun in the orbit's plane.
  double incidence(double beta) const;
  /// One step of the temperature. `electrical_W` are drawn from the panels, and do not heat them.
  void step(double dt_s, double electrical_W);

  double temperature_C() const { return temperature_C_; }

 private:
  ArrayConstants constants_;
  double flux_ = 0;  // share of the solar flux at normal incidence
  double temperature_C_ = 20;
};

}  // namespace reident::satcs::reference
