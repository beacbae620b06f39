#include "service/satcs/reference/reference_array.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reident::satcs::reference {

namespace {
constexpr double array_rated_C = 28;
}

SolarArray::SolarArray(const ArrayConstants& constants) : constants_(constants) {}

double SolarArray::string_current(int cells, double node_V) const {
  if (flux_ <= 0) return 0;
  const ArrayConstants& c = constants_;
  const double warmer_K = temperature_C_ - array_rated_C;
  const double short_A = c.string_current_A * flux_ * (1 + c.current_per_K * warmer_K);
  const double cell_V = (node_V + c.blocking_diode_V) / cells;
  const double open_V = c.cell_open_V + c.cell_open_V_per_K * warmer_K;
  return std::max(0.0, short_A * (1 - std::exp((cell_V - open_V) / c.cell_knee_V)));
}

double SolarArray::incidence(double beta) const {
  return std::cos(beta - constants_.cant_deg * std::numbers::pi / 180);
}

void SolarArray::step(double dt_s, double electrical_W) {
  constexpr double stefan_boltzmann = 5.670374e-8;  // [W/m2K4]
  const ArrayConstants& c = constants_;
  const double kelvin = temperature_C_ + 273.15;
  const double absorbed = c.solar_flux_W_m2 * flux_ * c.absorptance + c.earth_infrared_W_m2;
  const double emitted = 2 * c.emittance * stefan_boltzmann * kelvin * kelvin * kelvin * kelvin;
  temperature_C_ += dt_s * (absorbed - emitted - electrical_W / c.area_m2) / c.heat_capacity_J_m2K;
}

}  // namespace reident::satcs::reference
