#include "service/satcs/reference/reference_charger.hpp"

#include <algorithm>

namespace reident::satcs::reference {

namespace {
constexpr double charger_rated_C = 10;
}

double Charger::section_V(double battery_V, double charge_A) const {
  const double drop_V = constants_.drop_V * charge_A / (charge_A + constants_.knee_A);
  return battery_V + drop_V + constants_.series_ohm * charge_A;
}

double Charger::limit_V(double battery_C) const {
  const ChargerConstants& c = constants_;
  return c.cells * (c.cell_limit_V + c.cell_limit_V_per_K * (battery_C - charger_rated_C));
}

void Charger::step(double battery_V, double battery_C) {
  const double excess_V = battery_V - limit_V(battery_C);
  share_ = std::clamp(share_ - constants_.gain_per_Vs * excess_V * step_s_, 0.0, 1.0);
}

}  // namespace reident::satcs::reference
