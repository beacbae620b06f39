// What the spacecraft uses and when: the operations plan and the thermostats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "service/satcs/random.hpp"
#include "service/satcs/reference_constants.hpp"
#include "service/satcs/reference_life.hpp"
#include "service/satcs/reference_orbit.hpp"

namespace reident::satcs::reference {

enum Load : std::size_t {
  platform,
  payload,
  transmitter,
  equipment_heater,
  battery_heater_1,
  battery_heater_2,
  load_count
};

/// Which of the instruments and transmitters are on: a function of time, seed and modes alone.
class OperationsPlan {
 public:
  /// Of `life`, the modes alone count.
  OperationsPlan(const Orbit& orbit, const LoadConstants& constants, std::vector<LifeEvent> life,
                 std::uint64_t seed);

  struct On {
    bool payload = false;
    bool transmitter = false;
    bool safe_mode = false;
  };
  /// Over a station the transmitter is on, and in sunlight the cameras with it; besides, one
  /// recorded imaging session around noon in some orbits. In safe mode and in quiet stretches
  /// everything is off.
  On at(storage::Time time) const;

 private:
  bool in_session(storage::Time time) const;

  Orbit orbit_;
  LoadConstants constants_;
  std::vector<LifeEvent> life_;
  std::uint64_t seed_;
};

/// The demand of every load. Converters take constant power, heaters are resistors.
class Loads {
 public:
  Loads(const Orbit& orbit, const LoadConstants& constants, const std::vector<LifeEvent>& life,
        std::uint64_t seed);

  /// Once a second: the plan, the platform's slow variation and the thermostats.
  void update(storage::Time time, double illumination,
              const std::array<double, battery_count>& battery_C);

  /// Current of a load [A] at a bus voltage.
  double current_A(Load load, double bus_V) const;

  OperationsPlan::On on() const { return on_; }
  bool heater_on(std::size_t battery) const { return battery_heater_on_[battery]; }
  double equipment_C() const { return equipment_C_; }

 private:
  OperationsPlan plan_;
  LoadConstants constants_;
  RandomStream random_;
  OperationsPlan::On on_;
  double variation_W_ = 0;
  double equipment_C_ = 18;
  bool equipment_heater_on_ = false;
  std::array<bool, battery_count> battery_heater_on_{};
};

}  // namespace reident::satcs::reference
