// The 28 V bus: its capacitor and the main error amplifier that holds its voltage by shunting the
// array's channels or by calling on the discharge regulators.
//
//   C dV/dt = I_array - I_shunt(V_mea) + I_bdr(V_mea) - I_load
//   V_mea   = middle + gain (e + integral of e / integral_s),   e = V - reference
//
// V_mea low: the regulators work, more below. In the middle neither works. High: the channels are
// shunted one after the other, the one at work for a share of its time. The loop settles within a
// millisecond, far below a step of the plant, so a step solves it implicitly (backward Euler): the
// sum of currents falls with V in straight pieces and its root is exact.
#pragma once

#include <array>

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// Bus voltage and amplifier, in steps of `step_s` [s].
class Bus {
 public:
  Bus(const BusConstants& bus, const ErrorAmplifierConstants& mea, double step_s);

  using Channels = std::array<double, shunt_channels>;
  /// What meets at the bus during one step.
  struct Demand {
    Channels channel_A{};  // what the array gives in each channel
    double bdr_max_A = 0;  // what the regulators can give
    double load_A = 0;
  };
  /// What holds during the step, at the voltage that it leaves.
  struct Solution {
    double bdr_A = 0;
    double shunt_A = 0;
    Channels shunting{};     // the share of its time that each channel shunts
    double array_A = 0;      // of all channels
    double capacitor_A = 0;  // into the capacitor
    double capacitor_J = 0;  // stored by the step; the rest is lost in its series resistance
    double load_share = 1;   // of the demand that the loads get; below 1 in a brown-out
  };
  /// One step; the currents of the result balance to rounding.
  Solution step(const Demand& demand);

  double bus_V() const { return bus_V_; }
  double mea_V() const { return mea_V_; }

 private:
  // What the domains of V_mea give at a voltage of the amplifier.
  double bdr_A(double mea_V, const Demand& demand) const;
  double shunt_A(double mea_V, const Demand& demand) const;
  double shunting(double mea_V, std::size_t channel) const;

  BusConstants bus_;
  ErrorAmplifierConstants mea_;
  double step_s_;
  double bus_V_;
  double mea_V_;
  double integral_V_ = 0;                               // the integrator's part of V_mea
  std::array<double, shunt_channels + 3> corners_V_{};  // of V_mea where a piece ends, ascending
};

}  // namespace reident::satcs::reference
