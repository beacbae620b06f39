#include "service/satcs/reference/reference_battery.hpp"

#include <algorithm>
#include <cmath>

namespace reident::satcs::reference {

namespace {
constexpr double battery_rated_C = 10;
}

Battery::Battery(const BatteryConstants& constants, double step_s)
    : constants_(constants),
      step_s_(step_s),
      fast_decay_(std::exp(-step_s / constants.fast_s)),
      slow_decay_(std::exp(-step_s / constants.slow_s)),
      state_{.soc = constants.initial_soc, .temperature_C = constants.initial_C} {
  const auto& table = constants.cell_open_V;
  for (std::size_t i = 1; i < table.size(); ++i) {
    below_V_[i] = below_V_[i - 1] + (table[i - 1] + table[i]) / 2;
  }
}

double Battery::open_circuit_V() const {
  const auto& table = constants_.cell_open_V;
  const double at = std::clamp(state_.soc, 0.0, 1.0) * static_cast<double>(table.size() - 1);
  const auto left = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const double share = at - static_cast<double>(left);
  const double cell_V = table[left] + share * (table[left + 1] - table[left]) +
                        constants_.cell_open_V_per_K * (state_.temperature_C - battery_rated_C);
  return constants_.cells * cell_V;
}

double Battery::chemical_J() const {
  // The integral of the table's straight pieces.
  const auto& table = constants_.cell_open_V;
  const double at = state_.soc * static_cast<double>(table.size() - 1);
  const auto left = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const double share = at - static_cast<double>(left);
  const double pieces_V =
      below_V_[left] + share * (table[left] + share / 2 * (table[left + 1] - table[left]));
  return constants_.cells * 3600 * constants_.capacity_Ah * pieces_V /
         static_cast<double>(table.size() - 1);
}

double Battery::charge_efficiency() const {
  const BatteryConstants& c = constants_;
  return c.charge_efficiency / (1 + std::exp((state_.soc - c.full_soc) / c.full_width));
}

double Battery::terminal_V(double charge_A, double discharge_W) const {
  const double r = constants_.series_ohm;
  const double open = internal_V() + r * charge_A;
  // Beyond the most power that it can give the voltage stays at that point.
  return (open + std::sqrt(std::max(0.0, open * open - 4 * r * discharge_W))) / 2;
}

double Battery::stored_A(double current_A) const {
  return current_A > 0 ? current_A * charge_efficiency() : current_A;
}

void Battery::step(double current_A, double heater_W) {
  const BatteryConstants& c = constants_;
  const double taken_W = current_A * (internal_V() + c.series_ohm * current_A);
  const double before_J = chemical_J();
  state_.soc =
      std::clamp(state_.soc + stored_A(current_A) * step_s_ / (3600 * c.capacity_Ah), 0.0, 1.0);
  heat_W_ = taken_W - (chemical_J() - before_J) / step_s_;
  const double lost_W = c.conductance_W_K * (state_.temperature_C - c.radiator_C);
  state_.temperature_C += step_s_ * (heat_W_ + heater_W - lost_W) / c.heat_capacity_J_K;
  const auto relax = [&](double& pair_V, double ohm, double decay) {
    pair_V = ohm * current_A + (pair_V - ohm * current_A) * decay;
  };
  relax(state_.fast_V, c.fast_ohm, fast_decay_);
  relax(state_.slow_V, c.slow_ohm, slow_decay_);
}

}  // namespace reident::satcs::reference
