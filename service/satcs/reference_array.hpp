// The solar array: its temperature and the current of a section at a voltage.
#pragma once

#include "service/satcs/reference_constants.hpp"

namespace reident::satcs::reference {

/// One wing of two-faced panels at one temperature.
class SolarArray {
 public:
  explicit SolarArray(const ArrayConstants& constants);

  /// Current of one string [A] of `cells` in series that feeds a node at `node_V` through its
  /// blocking diode. Single exponential: I = I_sc (1 - exp((V - V_oc(T)) / V_knee)), never
  /// negative.
  double string_current(int cells, double node_V) const;

  /// `illumination` in [0, 1]; `beta` is the angle between the orbit's plane and the Sun [rad].
  void set_sun(double illumination, double beta);
  void step(double dt_s);

  double temperature_C() const { return temperature_C_; }

 private:
  ArrayConstants constants_;
  double flux_ = 0;  // share of the solar flux at normal incidence
  double temperature_C_ = 20;
};

}  // namespace reident::satcs::reference
