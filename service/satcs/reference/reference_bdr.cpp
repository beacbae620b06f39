#include "service/satcs/reference/reference_bdr.hpp"

#include <algorithm>

namespace reident::satcs::reference {

namespace {
constexpr double bdr_rated_C = 25;
}

DischargeRegulator::DischargeRegulator(const DischargeRegulatorConstants& constants, double step_s)
    : constants_(constants), step_s_(step_s) {}

double DischargeRegulator::max_output_A(const Supplied& supplied) const {
  const auto modules = std::count(supplied.begin(), supplied.end(), true);
  return constants_.max_output_A * static_cast<double>(modules) / battery_count;
}

DischargeRegulator::Modules DischargeRegulator::share(double output_A,
                                                      const Supplied& supplied) const {
  const double first = supplied[0] && supplied[1] ? share_ : (supplied[0] ? 1.0 : 0.0);
  return {first * output_A, (1 - first) * output_A};
}

double DischargeRegulator::loss_W(double output_A, double battery_V) const {
  const DischargeRegulatorConstants& c = constants_;
  const double ohm = c.series_ohm * (1 + c.series_per_K * (temperature_C_ - bdr_rated_C));
  return c.idle_W + (c.drop_V + ohm * output_A + c.switching * battery_V) * output_A;
}

void DischargeRegulator::step(const Modules& battery_V, double total_loss_W) {
  const DischargeRegulatorConstants& c = constants_;
  const double target = std::clamp(0.5 + c.sharing_per_V * (battery_V[0] - battery_V[1]), 0.2, 0.8);
  share_ += (target - share_) * step_s_ / c.sharing_s;
  const double lost_W = c.conductance_W_K * (temperature_C_ - c.base_C);
  temperature_C_ += step_s_ * (total_loss_W - lost_W) / c.heat_capacity_J_K;
}

}  // namespace reident::satcs::reference
