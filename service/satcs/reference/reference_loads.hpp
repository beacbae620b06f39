// What the spacecraft uses and when: the operations plan and the thermostats.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "service/satcs/reference/random.hpp"
#include "service/satcs/reference/reference_constants.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "service/satcs/reference/reference_orbit.hpp"

namespace reident::satcs::reference {

/// What the distributor feeds.
enum Load : std::size_t {
  platform,
  transmitter,
  equipment_heater,
  battery_heater_1,
  battery_heater_2,
  converter_1,  // and so on for every line
  load_count = converter_1 + converter_count
};

/// Which of the instruments and transmitters are on: a function of time, seed and modes alone.
class OperationsPlan {
 public:
  /// The modes of `life` alone count.
  OperationsPlan(const Orbit& orbit, const LoadConstants& constants, std::vector<LifeEvent> life,
                 std::uint64_t seed);

  /// What is on at a time.
  struct On {
    bool payload = false;
    bool transmitter = false;
    bool safe_mode = false;
  };
  /// Over a station the transmitter is on, and in sunlight the cameras with it; besides, one
  /// recorded imaging session around noon in some orbits. In safe mode and in quiet times
  /// everything is off.
  On at(storage::Time time) const;

 private:
  bool in_session(storage::Time time) const;

  Orbit orbit_;
  LoadConstants constants_;
  std::vector<LifeEvent> life_;
  std::uint64_t seed_;
};

/// Whether a heater is on that was `on` before: between the limits it stays as it is.
bool thermostat(bool on, double temperature_C, const ThermostatConstants& limits);

/// A slow variation: Ornstein and Uhlenbeck's process, exact over one second.
class SlowVariation {
 public:
  /// `sigma`: standard deviation in the long run; begins at 0.
  SlowVariation(double sigma, double correlation_s)
      : keep_(std::exp(-1 / correlation_s)), kick_(sigma * std::sqrt(1 - keep_ * keep_)) {}
  void advance(RandomStream& random) { value_ = keep_ * value_ + kick_ * random.gaussian(); }
  double value() const { return value_; }

 private:
  double keep_, kick_;
  double value_ = 0;
};

/// The demand of every user. The platform and the transmitter take constant power, heaters are
/// resistors, and the users of the secondary lines take currents. update() comes once before the
/// first currents_A().
class Loads {
 public:
  Loads(const Orbit& orbit, const LoadConstants& constants, const std::vector<LifeEvent>& life,
        std::uint64_t seed);
  void age(const LoadConstants& constants) { constants_ = constants; }

  /// Once a second: the plan, the slow variations and the thermostats.
  void update(storage::Time time, double illumination,
              const std::array<double, battery_count>& battery_C);

  using Currents = std::array<double, load_count>;
  /// Current of each load [A] at the distributor's voltage; of the converters, which take
  /// `converter_W`.
  Currents currents_A(double distributor_V,
                      const std::array<double, converter_count>& converter_W) const;
  /// Current that the users of a secondary line take [A].
  double line_A(std::size_t line) const { return line_A_[line]; }

  OperationsPlan::On on() const { return on_; }
  bool battery_heater_on(std::size_t battery) const { return battery_heater_on_[battery]; }
  bool equipment_heater_on() const { return equipment_heater_on_; }
  double equipment_C() const { return equipment_C_; }

 private:
  OperationsPlan plan_;
  LoadConstants constants_;
  RandomStream random_;
  OperationsPlan::On on_;
  SlowVariation platform_variation_;
  std::array<SlowVariation, converter_count> line_variation_;
  std::array<double, converter_count> line_A_{};
  double equipment_C_ = 18;
  bool equipment_heater_on_ = false;
  std::array<bool, battery_count> battery_heater_on_{};
};

}  // namespace reident::satcs::reference
