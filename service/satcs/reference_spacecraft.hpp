// The reference spacecraft: a CBERS-4-class electrical power subsystem and its telemetry at 1 Hz.
//
// The same start and seed give the same telemetry to the last bit.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "service/satcs/reference_plant.hpp"
#include "service/satcs/reference_sensor.hpp"
#include "storage/telemetry.hpp"

namespace reident::satcs::reference {

/// A telemetry point: what it reads, and its sensor. Digital ones are 0 or 1 and have none.
struct TelemetryPoint {
  std::string_view name;
  std::string_view unit;
  std::string_view description;
  storage::ParameterKind kind = storage::ParameterKind::analog;
  double (*read)(const Plant& plant) = nullptr;
  SensorSpec sensor;
};

/// Every point, in the order of the samples of a reading. Their ids follow from their names
/// (parameter_id).
std::span<const TelemetryPoint> telemetry_points();
/// Their descriptors; the limits are the ends of the sensors' ranges.
std::vector<storage::ParameterDescriptor> telemetry_descriptors(std::string_view spacecraft);

/// `time` rounded down to a second.
storage::Time whole_seconds(storage::Time time);

class Spacecraft {
 public:
  /// The first reading is of `start`, rounded down to a second. `life` happens to a spacecraft of
  /// the constants `fresh`; every event must be without life_mistake().
  Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
             std::uint64_t seed);

  storage::Time time() const { return plant_.time(); }
  const Plant& plant() const { return plant_; }
  /// One sample for each telemetry point, now.
  void read(std::vector<storage::Sample>& samples);
  /// What each sensor would read without noise and converter, now.
  std::vector<double> noise_free() const;
  /// Goes on by one second.
  void advance();

 private:
  void observe();

  Plant plant_;
  std::vector<Sensor> sensors_;  // of the analog points, in their order
};

}  // namespace reident::satcs::reference
