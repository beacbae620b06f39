// A battery charge controller: it shunts a share of its section's current so that the battery stays
// below a limit, which falls with the battery's temperature. Main and redundant differ a little.
#pragma once

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// One controller, in steps of `step_s` [s]: an integrator of the voltage above the limit.
class Charger {
 public:
  Charger(const ChargerConstants& constants, double step_s)
      : constants_(constants), step_s_(step_s) {}
  /// Also the switch to the other controller, which goes on from the share of this one.
  void age(const ChargerConstants& constants) { constants_ = constants; }

  /// The share of the section's current that is let through, in [0, 1].
  double share() const { return share_; }
  /// The section's voltage while a current goes to the battery.
  double section_V(double battery_V, double charge_A) const;
  /// The battery's voltage that is held at a temperature.
  double limit_V(double battery_C) const;

  /// One step of the share, which stays in [0, 1].
  void step(double battery_V, double battery_C);

 private:
  ChargerConstants constants_;
  double step_s_;
  double share_ = 1;
};

}  // namespace reident::satcs::reference
