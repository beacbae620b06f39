// The reference spacecraft's electrical power subsystem without sensors: states, and the currents
// and voltages of one step, which balance at every node to rounding, as do its powers.
//
//   SAG1A -- charger 1 --+-- battery 1          SAG2 -- six shunt channels --+
//                        +-- BDR module 1 --+                               |
//   SAG1B -- charger 2 --+-- battery 2      +-------------------------------+-- bus -- harness --
//                        +-- BDR module 2 --+                               +-- capacitor        |
//                                                                                                |
//           secondary lines -- three DC/DC converters --+-- heaters, transmitter, platform --
//           distributor
//
// Within a step the converters, heaters and the array see the voltages of the step before (their
// filters hold that long); everything else is solved together. Powers are those of the currents at
// the voltages that the step leaves, so that no energy is lost between steps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "service/satcs/reference/reference_array.hpp"
#include "service/satcs/reference/reference_battery.hpp"
#include "service/satcs/reference/reference_bdr.hpp"
#include "service/satcs/reference/reference_bus.hpp"
#include "service/satcs/reference/reference_charger.hpp"
#include "service/satcs/reference/reference_constants.hpp"
#include "service/satcs/reference/reference_converter.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "service/satcs/reference/reference_loads.hpp"
#include "service/satcs/reference/reference_orbit.hpp"

namespace reident::satcs::reference {

/// The electrical quantities of one step; constant over it.
struct Flows {
  using PerBattery = std::array<double, battery_count>;
  double illumination = 0;
  PerBattery section_A{};        // SAG1A, SAG1B
  PerBattery section_shunt_A{};  // what their chargers shunt
  PerBattery charge_A{};         // section_A - section_shunt_A
  PerBattery section_V{};
  PerBattery battery_A{};  // into the battery: charge_A - bdr_in_A
  PerBattery battery_V{};
  PerBattery stored_A{};  // the part of battery_A that changes the state of charge
  PerBattery bdr_in_A{};
  PerBattery bdr_module_A{};  // output of each module
  PerBattery bdr_loss_W{};
  double bdr_out_A = 0;
  double array_A = 0;  // SAG2, all channels
  double shunt_A = 0;
  Bus::Channels shunting{};  // the share of its time that each channel shunts
  double sg2_A = 0;          // array_A - shunt_A
  double bus_A = 0;          // sg2_A + bdr_out_A
  double capacitor_A = 0;
  double capacitor_J = 0;  // stored by the step
  Loads::Currents load_A{};
  double distributor_A = 0;  // the sum of load_A; with capacitor_A it is bus_A
  std::array<double, converter_count> line_A{};
  std::array<double, converter_count> line_V{};
  double bus_V = 0;  // at the end of the step, as all voltages
  double distributor_V = 0;
  double mea_V = 0;
};

/// Where the arrays' power went in one step [W]; `array` is the sum of the others.
struct PowerBalance {
  double array = 0;
  // Losses.
  double blocking_diodes = 0;
  double shunt_switches = 0;  // of SAG2 and of the chargers
  double chargers = 0;
  double discharge_regulators = 0;
  double harness = 0;
  double converters = 0;
  double capacitor_resistance = 0;
  double battery_heat = 0;  // negative while the batteries cool themselves
  // Use.
  double platform = 0;
  double transmitter = 0;
  double heaters = 0;
  double secondary_lines = 0;
  // Stored.
  double capacitor = 0;
  double batteries = 0;

  double losses() const {
    return blocking_diodes + shunt_switches + chargers + discharge_regulators + harness +
           converters + capacitor_resistance + battery_heat;
  }
  double use() const { return platform + transmitter + heaters + secondary_lines; }
  double stored() const { return capacitor + batteries; }
};

/// States and flows, step by step. Equal arguments give equal flows to the last bit.
class Plant {
 public:
  static constexpr int usual_steps_per_second = 4;

  /// At `start`, a multiple of a second; one orbit before it has been simulated already, so that
  /// temperatures and charge are on their way round the orbit. `fresh` are the constants before any
  /// event of `life`.
  Plant(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
        std::uint64_t seed, int steps_per_second = usual_steps_per_second);

  /// One step; at the begin of a second the life and the loads go on first.
  void step();
  int steps_per_second() const { return steps_per_second_; }
  double step_s() const { return step_s_; }

  /// The end of the last step.
  storage::Time time() const;
  /// What the last step had.
  const Flows& flows() const { return flows_; }
  /// The balance of the last step.
  PowerBalance power_balance() const;
  const Battery& battery(std::size_t k) const { return batteries_[k]; }
  const DischargeRegulator& bdr() const { return bdr_; }
  const Converters& converters() const { return converters_; }
  /// As aged as they are now.
  const Constants& constants() const { return constants_; }
  const SolarArray& array() const { return array_; }
  const Loads& loads() const { return loads_; }
  const Orbit& orbit() const { return orbit_; }

 private:
  void begin_second();
  void age();
  DischargeRegulator::Supplied modules_supplied() const;
  void solve_bus();
  void solve_battery(std::size_t k);
  double array_W() const;
  double converter_loss_W() const;

  int steps_per_second_;
  double step_s_;
  Constants fresh_;
  std::vector<LifeEvent> life_;
  Constants constants_;  // of the running second
  Orbit orbit_;
  SolarArray array_;
  std::array<Battery, battery_count> batteries_;
  std::array<Charger, battery_count> chargers_;
  DischargeRegulator bdr_;
  Converters converters_;
  Bus bus_;
  Loads loads_;
  Flows flows_;

  storage::Time second_;  // the running second began here
  int step_in_second_ = 0;
  double illumination_begin_ = 0, illumination_end_ = 0;  // of the running second
  double incidence_ = 1;
  double relative_flux_ = 1;
};

}  // namespace reident::satcs::reference
