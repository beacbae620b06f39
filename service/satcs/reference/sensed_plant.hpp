// A plant with the sensors of its telemetry points: a reading a second.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "service/satcs/reference/telemetry_point.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs::reference {

/// `time` rounded down to a second.
storage::Time whole_seconds(storage::Time time);

/// Plant and sensors, second by second. One thread at a time. `Plant` has step(),
/// steps_per_second(), step_s() and time().
template <class Plant>
class SensedPlant {
 public:
  storage::Time time() const { return plant_.time(); }
  const Plant& plant() const { return plant_; }

  /// Replaces `samples` by one sample for each telemetry point that is due now. Draws noise: call
  /// it once a second.
  void read(std::vector<storage::Sample>& samples) {
    const std::int64_t second = time() / storage::second_ns;
    samples.clear();
    for (Channel& channel : channels_) {
      if (!channel.point->due(second)) continue;
      const double value =
          channel.point->digital() ? channel.point->read(plant_) : channel.sensor.read();
      samples.push_back({channel.id, storage::Quality::good, value});
    }
  }

  /// What the sensor of each telemetry point, due or not, would read now without noise and
  /// converter.
  std::vector<double> noise_free() const {
    std::vector<double> values;
    for (const Channel& channel : channels_) {
      values.push_back(channel.point->digital() ? channel.point->read(plant_)
                                                : channel.sensor.filtered());
    }
    return values;
  }

  /// Goes on by one second.
  void advance() {
    for (int step = 0; step < plant_.steps_per_second(); ++step) {
      plant_.step();
      observe();
    }
  }

 protected:
  /// The first reading is of the plant's time. `points` outlive this.
  SensedPlant(Plant plant, std::span<const PointOf<Plant>> points, std::uint64_t seed)
      : plant_(std::move(plant)) {
    for (const PointOf<Plant>& point : points) {
      const auto id = parameter_id(point.name);
      channels_.push_back({&point, id, Sensor(point.sensor, plant_.step_s(), seed, id)});
    }
    observe();
  }

 private:
  struct Channel {
    const PointOf<Plant>* point;
    std::uint32_t id;
    Sensor sensor;  // of an analog point
  };

  void observe() {
    for (Channel& channel : channels_) {
      if (!channel.point->digital()) channel.sensor.observe(channel.point->read(plant_));
    }
  }

  Plant plant_;
  std::vector<Channel> channels_;  // in the order of the points
};

}  // namespace reident::satcs::reference
