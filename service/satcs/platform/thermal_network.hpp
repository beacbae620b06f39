// Temperatures of nodes that conduct heat to each other and radiate it to space.
//
//   C_i dT_i/dt = Q_i + sum_j G_ij (T_j - T_i) - sigma (eps A)_i T_i^4      T in kelvin
//
// Q_i is what the node takes up: sunlight, infrared, heaters and the losses of its units.
#pragma once

#include <array>

#include "service/satcs/platform/platform_constants.hpp"

namespace reident::satcs::platform {

using NodeValues = std::array<double, node_count>;

class ThermalNetwork {
 public:
  ThermalNetwork(const ThermalConstants& constants, double step_s);
  void age(const ThermalConstants& constants) { constants_ = constants; }

  double temperature_C(std::size_t node) const { return temperature_C_[node]; }
  /// Goes on by one step in which the nodes take up `heat_W`.
  void step(const NodeValues& heat_W);

  /// What the nodes radiated in the last step [W].
  double emitted_W() const { return emitted_W_; }
  /// Heat above 0 degC that the nodes hold [J].
  double stored_J() const;

 private:
  double emitting_m2(std::size_t node) const;

  ThermalConstants constants_;
  double step_s_;
  NodeValues temperature_C_;
  double emitted_W_ = 0;
};

}  // namespace reident::satcs::platform
