// The transmitter: the plan of its drive, and a power amplifier.
//
//   P_out = P_sat tanh(g D / P_sat),      g falls with the case's temperature [dB/K]
//   P_supply = P_q + a P_out + r sqrt(P_out P_sat)
//
// What is not sent is heat of the case.
#pragma once

#include <cstdint>
#include <vector>

#include "service/satcs/platform/platform_constants.hpp"
#include "service/satcs/reference/reference_loads.hpp"

namespace reident::satcs::platform {

/// The level that drives the amplifier [mW]; 0: switched off. A function of time, seed and modes.
class DrivePlan {
 public:
  DrivePlan(const reference::Orbit& orbit, const Constants& constants,
            const std::vector<reference::LifeEvent>& life, std::uint64_t seed);

  /// Over a station, and in up to two ranging sessions in an orbit. The level changes each minute.
  double drive_mW(storage::Time time) const;

 private:
  bool in_session(storage::Time time) const;

  reference::Orbit orbit_;
  reference::OperationsPlan plan_;
  std::vector<reference::LifeEvent> life_;
  TransmitterConstants constants_;
  std::uint64_t seed_;
};

class Transmitter {
 public:
  Transmitter(const TransmitterConstants& constants, double step_s);
  void age(const TransmitterConstants& constants) { constants_ = constants; }

  /// One step with a drive; 0 switches the amplifier off.
  void step(double drive_mW, double case_C);

  bool on() const { return drive_mW_ > 0; }
  double drive_mW() const { return drive_mW_; }
  double output_W() const { return output_W_; }
  double supply_W() const { return supply_W_; }
  double heat_W() const { return supply_W_ - output_W_; }

 private:
  TransmitterConstants constants_;
  double step_s_;
  double cold_ = 1;  // how far the amplifier is from its gain when warmed up; 1: just switched on
  double drive_mW_ = 0, output_W_ = 0, supply_W_ = 0;
};

}  // namespace reident::satcs::platform
