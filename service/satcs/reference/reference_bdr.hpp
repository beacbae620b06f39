// The battery discharge regulators: how two modules share the output, and what they lose.
//
//   V_battery I_in = V_bus I_out + loss,   loss = idle + drop I + R(T) I^2 + switching V_battery I
#pragma once

#include <array>

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// Both modules, in steps of `step_s` [s].
class DischargeRegulator {
 public:
  DischargeRegulator(const DischargeRegulatorConstants& constants, double step_s);
  /// Goes on with other constants; sharing and temperature stay.
  void age(const DischargeRegulatorConstants& constants) { constants_ = constants; }

  using Modules = std::array<double, battery_count>;
  using Supplied = std::array<bool, battery_count>;  // modules whose battery has charge and voltage
  /// What the modules that are supplied can give together [A].
  double max_output_A(const Supplied& supplied) const;
  /// Output current of each module [A]: the fuller battery gives more, after a while.
  Modules share(double output_A, const Supplied& supplied) const;
  /// Loss of a working module [W] at an output current and the voltage of its battery.
  double loss_W(double output_A, double battery_V) const;

  /// One step of the sharing and of the temperature.
  void step(const Modules& battery_V, double total_loss_W);

  double temperature_C() const { return temperature_C_; }

 private:
  DischargeRegulatorConstants constants_;
  double step_s_;
  double share_ = 0.5;  // of the first module
  double temperature_C_ = 25;
};

}  // namespace reident::satcs::reference
