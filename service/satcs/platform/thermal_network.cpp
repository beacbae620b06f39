#include "service/satcs/platform/thermal_network.hpp"

namespace reident::satcs::platform {
namespace {

constexpr double stefan_boltzmann = 5.670374e-8;  // [W/m2K4]
constexpr double zero_K = 273.15;

}  // namespace

ThermalNetwork::ThermalNetwork(const ThermalConstants& constants, double step_s)
    : constants_(constants), step_s_(step_s), temperature_C_(constants.initial_C) {}

double ThermalNetwork::emitting_m2(std::size_t node) const {
  if (node < panel_count) return constants_.panel[node].area_m2 * constants_.panel[node].emittance;
  return node == tank ? constants_.tank_emitting_m2 : 0;
}

void ThermalNetwork::step(const NodeValues& heat_W) {
  NodeValues net_W = heat_W;
  for (const LinkConstants& link : constants_.link) {
    const double flow_W = link.conductance_W_K * (temperature_C_[link.a] - temperature_C_[link.b]);
    net_W[link.a] -= flow_W;
    net_W[link.b] += flow_W;
  }
  emitted_W_ = 0;
  for (std::size_t node = 0; node < node_count; ++node) {
    const double area_m2 = emitting_m2(node);
    if (area_m2 == 0) continue;
    const double kelvin = temperature_C_[node] + zero_K;
    const double emitted_W = stefan_boltzmann * area_m2 * kelvin * kelvin * kelvin * kelvin;
    net_W[node] -= emitted_W;
    emitted_W_ += emitted_W;
  }
  for (std::size_t node = 0; node < node_count; ++node)
    temperature_C_[node] += step_s_ * net_W[node] / constants_.heat_capacity_J_K[node];
}

double ThermalNetwork::stored_J() const {
  double stored = 0;
  for (std::size_t node = 0; node < node_count; ++node)
    stored += constants_.heat_capacity_J_K[node] * temperature_C_[node];
  return stored;
}

}  // namespace reident::satcs::platform
