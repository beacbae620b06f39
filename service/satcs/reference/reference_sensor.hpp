// From a quantity of the plant to what the telemetry says about it.
#pragma once

#include <cstdint>

#include "service/satcs/reference/random.hpp"

namespace reident::satcs::reference {

/// A first-order low-pass, Gaussian noise, and a converter of `bits` over [low, high].
struct SensorSpec {
  double time_constant_s = 1;
  double noise = 0;  // standard deviation, in the unit of the quantity
  double low = 0;    // range of the converter; what lies beyond reads as its end
  double high = 1;
  int bits = 12;

  double quantum() const { return (high - low) / static_cast<double>((1 << bits) - 1); }
};

/// One sensor, observing in steps of `step_s` [s]. Its noise follows from seed and stream, one
/// stream a sensor.
class Sensor {
 public:
  Sensor(const SensorSpec& spec, double step_s, std::uint64_t seed, std::uint64_t stream);

  /// The quantity during one step; the first one sets the filter.
  void observe(double value) {
    filtered_ = started_ ? value + (filtered_ - value) * decay_ : value;
    started_ = true;
  }
  /// After the filter, without noise and converter.
  double filtered() const { return filtered_; }
  /// One conversion, with noise of its own: a multiple of the quantum within the range.
  double read();

 private:
  SensorSpec spec_;
  double decay_;
  double quantum_;
  double filtered_ = 0;
  bool started_ = false;
  RandomStream random_;
};

}  // namespace reident::satcs::reference
