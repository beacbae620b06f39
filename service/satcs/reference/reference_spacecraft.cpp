#include "service/satcs/reference/reference_spacecraft.hpp"

#include <chrono>
#include <utility>

#include "service/satcs/parameter_id.hpp"

namespace reident::satcs::reference {

storage::Time whole_seconds(storage::Time time) {
  using std::chrono::nanoseconds;
  return nanoseconds(std::chrono::floor<std::chrono::seconds>(nanoseconds(time))).count();
}

Spacecraft::Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
                       std::uint64_t seed)
    : plant_(fresh, std::move(life), whole_seconds(start), seed) {
  for (const TelemetryPoint& point : telemetry_points()) {
    const auto id = parameter_id(point.name);
    channels_.push_back({&point, id, Sensor(point.sensor, plant_.step_s(), seed, id)});
  }
  observe();
}

void Spacecraft::read(std::vector<storage::Sample>& samples) {
  const std::int64_t second = time() / storage::second_ns;
  samples.clear();
  for (Channel& channel : channels_) {
    if (!channel.point->due(second)) continue;
    const double value = channel.digital() ? channel.point->read(plant_) : channel.sensor.read();
    samples.push_back({channel.id, storage::Quality::good, value});
  }
}

std::vector<double> Spacecraft::noise_free() const {
  std::vector<double> values;
  for (const Channel& channel : channels_) {
    values.push_back(channel.digital() ? channel.point->read(plant_) : channel.sensor.filtered());
  }
  return values;
}

void Spacecraft::advance() {
  for (int step = 0; step < plant_.steps_per_second(); ++step) {
    plant_.step();
    observe();
  }
}

void Spacecraft::observe() {
  for (Channel& channel : channels_) {
    if (!channel.digital()) channel.sensor.observe(channel.point->read(plant_));
  }
}

}  // namespace reident::satcs::reference
