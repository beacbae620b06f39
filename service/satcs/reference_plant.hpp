// The reference spacecraft's electrical power subsystem without sensors: states, and the currents
// and voltages of one step, which balance at every node to rounding.
//
//   SAG1A -- charger 1 --+-- battery 1          SAG2 -- six shunt channels --+
//                        +-- BDR module 1 --+                               |
//   SAG1B -- charger 2 --+-- battery 2      +------------------------------+-- bus -- loads
//                        +-- BDR module 2 --+                               +-- capacitor
//
// Within a step the converters' inputs and the array see the voltages of the step before (their
// filters hold that long); everything else is solved together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "service/satcs/reference_array.hpp"
#include "service/satcs/reference_battery.hpp"
#include "service/satcs/reference_bdr.hpp"
#include "service/satcs/reference_bus.hpp"
#include "service/satcs/reference_constants.hpp"
#include "service/satcs/reference_life.hpp"
#include "service/satcs/reference_loads.hpp"
#include "service/satcs/reference_orbit.hpp"

namespace reident::satcs::reference {

/// The electrical quantities of one step; constant over it.
struct Flows {
  using PerBattery = std::array<double, battery_count>;
  double illumination = 0;
  PerBattery section_A{};        // SAG1A, SAG1B
  PerBattery section_shunt_A{};  // what their chargers shunt
  PerBattery charge_A{};         // section_A - section_shunt_A
  PerBattery battery_A{};        // into the battery: charge_A - bdr_in_A
  PerBattery battery_V{};
  PerBattery stored_A{};  // the part of battery_A that changes the state of charge
  PerBattery bdr_in_A{};
  PerBattery bdr_module_A{};  // output of each module
  PerBattery bdr_loss_W{};
  double bdr_out_A = 0;
  double array_A = 0;  // SAG2, all channels
  double shunt_A = 0;
  double sg2_A = 0;  // array_A - shunt_A
  double bus_A = 0;  // sg2_A + bdr_out_A
  double capacitor_A = 0;
  std::array<double, load_count> load_A{};  // with capacitor_A they sum up to bus_A
  double bus_V = 0;                         // at the end of the step
  double mea_V = 0;
};

class Plant {
 public:
  static constexpr int steps_per_second = 20;
  static constexpr double step_s = 1.0 / steps_per_second;

  /// At `start`, a multiple of a second; one orbit before it has been simulated already, so that
  /// temperatures and charge are on their way round the orbit. `fresh` are the constants before any
  /// event of `life`.
  Plant(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
        std::uint64_t seed);

  void step();

  storage::Time time() const;
  const Flows& flows() const { return flows_; }
  const Battery& battery(std::size_t k) const { return batteries_[k]; }
  const DischargeRegulator& bdr() const { return bdr_; }
  const SolarArray& array() const { return array_; }
  const Loads& loads() const { return loads_; }
  const Orbit& orbit() const { return orbit_; }

 private:
  void begin_second();
  void age();
  DischargeRegulator::Supplied modules_supplied() const;
  void solve_bus();
  void solve_battery(std::size_t k);

  Constants fresh_;
  std::vector<LifeEvent> life_;
  Constants constants_;  // of the running second
  Orbit orbit_;
  SolarArray array_;
  std::array<Battery, battery_count> batteries_;
  DischargeRegulator bdr_;
  Bus bus_;
  Loads loads_;
  Flows flows_;

  storage::Time second_;  // the running second began here
  int step_in_second_ = 0;
  double illumination_begin_ = 0, illumination_end_ = 0;  // of the running second
  double incidence_ = 1;
  std::array<double, battery_count> charging_;  // share of the section's current let through
};

}  // namespace reident::satcs::reference
