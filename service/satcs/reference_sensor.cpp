#include "service/satcs/reference_sensor.hpp"

#include <algorithm>
#include <cmath>

namespace reident::satcs::reference {

Sensor::Sensor(const SensorSpec& spec, double step_s, std::uint64_t seed, std::uint64_t stream)
    : spec_(spec), decay_(std::exp(-step_s / spec.time_constant_s)), random_(seed, stream) {}

void Sensor::observe(double value) {
  filtered_ = started_ ? value + (filtered_ - value) * decay_ : value;
  started_ = true;
}

double Sensor::read() {
  const double noisy = filtered_ + spec_.noise * random_.gaussian();
  const double held = std::clamp(noisy, spec_.low, spec_.high);
  return spec_.low + spec_.quantum() * std::round((held - spec_.low) / spec_.quantum());
}

}  // namespace reident::satcs::reference
