#include "service/satcs/reference/reference_sensor.hpp"

#include <algorithm>
#include <cmath>

namespace reident::satcs::reference {

Sensor::Sensor(const SensorSpec& spec, double step_s, std::uint64_t seed, std::uint64_t stream)
    : spec_(spec),
      decay_(std::exp(-step_s / spec.time_constant_s)),
      quantum_(spec.quantum()),
      random_(seed, stream) {}

double Sensor::read() {
  const double noisy = filtered_ + spec_.noise * random_.gaussian();
  const double held = std::clamp(noisy, spec_.low, spec_.high);
  // The nearest step; the quotient is never negative.
  return spec_.low + quantum_ * std::floor((held - spec_.low) / quantum_ + 0.5);
}

}  // namespace reident::satcs::reference
