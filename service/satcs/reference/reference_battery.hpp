// A battery: open-circuit voltage over charge and temperature, a series resistance and two
// resistor-capacitor pairs, charge efficiency, and heat.
//
// Whatever power is not stored as charge is heat.
//
//   V = V_oc(soc, T) + R_0 I + v_fast + v_slow      I > 0 charges [A]
//   dv/dt = (R I - v) / tau                         for each pair
//   dsoc/dt = eta(soc, I) I / capacity
#pragma once

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// One battery in steps of `step_s` [s].
class Battery {
 public:
  Battery(const BatteryConstants& constants, double step_s);
  /// Goes on with other constants. The state of charge stays a share of the capacity.
  void age(const BatteryConstants& constants) { constants_ = constants; }

  struct State {
    double soc = 0;     // share of the capacity, 0 to 1
    double fast_V = 0;  // voltages of the two pairs
    double slow_V = 0;
    double temperature_C = 0;
  };
  const State& state() const { return state_; }

  /// At rest, at the present charge and temperature.
  double open_circuit_V() const;
  /// Chemical energy above that of an empty battery [J], at 10 degC: what the temperature adds to
  /// the voltage is heat that it takes from the cells or gives to them.
  double chemical_J() const;
  /// What drives the current behind the series resistance: the terminal voltage at no current.
  double internal_V() const { return open_circuit_V() + state_.fast_V + state_.slow_V; }
  /// The share of a charging current that is stored at the present state of charge.
  double charge_efficiency() const;
  /// Terminal voltage when `charge_A` flows in and a regulator takes `discharge_W` out: the upper
  /// root of V = internal_V + R_0 (charge_A - discharge_W / V).
  double terminal_V(double charge_A, double discharge_W) const;
  /// The current that is stored, or taken from the store, of a terminal current.
  double stored_A(double current_A) const;

  /// One step of constant terminal current, at the voltage `internal_V() + R_0 current_A`;
  /// `heater_W` warms the cells.
  void step(double current_A, double heater_W);
  /// The heat of the last step, without the heater's [W].
  double heat_W() const { return heat_W_; }

 private:
  BatteryConstants constants_;
  double step_s_;
  std::array<double, 21> below_V_{};  // sum of the mean voltages of the table's pieces before each
  double fast_decay_, slow_decay_;    // of the pairs in one step
  State state_;
  double heat_W_ = 0;
};

}  // namespace reident::satcs::reference
