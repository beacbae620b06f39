// The reference spacecraft: a CBERS-4-class electrical power subsystem and its telemetry, a frame a
// second.
//
// Equal constants, life, start and seed give equal telemetry to the last bit.
#pragma once

#include <cstdint>
#include <vector>

#include "service/satcs/reference/reference_plant.hpp"
#include "service/satcs/reference/reference_sensor.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// `time` rounded down to a second.
storage::Time whole_seconds(storage::Time time);

/// Plant and sensors, second by second. One thread at a time.
class Spacecraft {
 public:
  /// The first reading is of `start`, rounded down to a second. `life` happens to a spacecraft of
  /// the constants `fresh`; every event must be without life_mistake().
  Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
             std::uint64_t seed);

  storage::Time time() const { return plant_.time(); }
  const Plant& plant() const { return plant_; }
  /// Replaces `samples` by one sample for each telemetry point that is due now. Draws noise: call
  /// it once a second.
  void read(std::vector<storage::Sample>& samples);
  /// What the sensor of each telemetry point, due or not, would read now without noise and
  /// converter.
  std::vector<double> noise_free() const;
  /// Goes on by one second.
  void advance();

 private:
  struct Channel {
    const TelemetryPoint* point;
    std::uint32_t id;
    Sensor sensor;  // of an analog point

    bool digital() const { return point->kind == storage::ParameterKind::digital; }
  };

  void observe();

  Plant plant_;
  std::vector<Channel> channels_;  // in the order of telemetry_points()
};

}  // namespace reident::satcs::reference
