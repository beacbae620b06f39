// The simulator's own model of the reference spacecraft's power subsystem, as a project writes it
// before launch from data sheets and the power budget. It is what identified models replace, and it
// is tuned to nothing that the spacecraft has sent.
//
//   I_SG2    = min(loads, array),  I_BDROUT = loads - I_SG2,  V_BUS constant
//   V_BAT I_BDRIN = V_BUS I_BDROUT / efficiency, half for each battery
//   V_BAT    = open circuit + R I_BAT, the open circuit a straight line over charge
//   28 V I_DCnIN = V_n I_DCnOUT / efficiency, V_n constant and the users' currents those of the
//   plan
//
// The orbit and the operations plan, with its safe modes and quiet times, are the spacecraft's
// own: operators know them. There is no temperature, no thermostat, no dynamics but the charge, no
// harness, no noise, no sensor and no error amplifier (REFERENCE.md).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "service/satcs/reference/reference_constants.hpp"
#include "service/satcs/reference/reference_loads.hpp"
#include "service/satcs/reference/reference_orbit.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// What the project takes from data sheets and the power budget.
struct HandwrittenConstants {
  double bus_V = 28;
  double bus_array_A = 45;       // SAG2 in sunlight: 90 strings of 0.5 A
  double charge_array_A = 6.5;   // SAG1A, SAG1B each: 13 strings of 0.5 A
  double platform_W = 400;       // on the bus itself
  double platform_safe_W = 250;  // in safe mode
  double transmitter_W = 230;
  /// The secondary lines' users, from their data sheets.
  struct Line {
    double output_V = 0;
    double base_A = 0;
    double payload_A = 0;      // more while the cameras are on
    double transmitter_A = 0;  // more while the transmitter is on
  };
  std::array<Line, reference::converter_count> line{Line{5, 20, 0, 4}, Line{15, 7, 0, 0},
                                                    Line{12, 3, 22, 0}};
  double converter_efficiency = 0.85;
  double heaters_W = 92.5;  // all of them, half of the time
  double bdr_efficiency = 0.90;
  double capacity_Ah = 50;
  double initial_charge = 0.95;  // share of the capacity
  double empty_V = 38 * 1.10;    // 38 cells in series, without current
  double full_V = 38 * 1.40;
  double battery_ohm = 0.05;
};

/// Steps once a second. The same arguments give the same samples to the last bit.
class HandwrittenEps {
 public:
  /// From `start`, rounded down to a second, with the operations plan of `seed` and
  /// the modes of `life`.
  HandwrittenEps(const reference::Constants& spacecraft, std::vector<reference::LifeEvent> life,
                 storage::Time start, std::uint64_t seed);

  storage::Time time() const { return time_; }
  /// A sample for each of handwritten_descriptors() that is due now, as on the spacecraft.
  void read(std::vector<storage::Sample>& samples) const;
  /// Goes on by one second.
  void advance();

  /// What holds during the present second.
  struct Flows {
    double load_A = 0, array_A = 0, sg2_A = 0, shunt_A = 0, bdr_out_A = 0;
    // Parts of load_A.
    double platform_A = 0, transmitter_A = 0, heaters_A = 0;
    std::array<double, reference::converter_count> converter_A{};
    std::array<double, reference::converter_count> line_A{}, line_V{};  // behind the converters
    double section_A = 0;                                               // SAG1A, SAG1B: the same
    // Each battery; both are alike.
    double charge_A = 0, bdr_in_A = 0, battery_A = 0, battery_V = 0;
    double bus_V = 0;
    reference::OperationsPlan::On on;
  };
  const Flows& flows() const { return flows_; }
  /// The charge of each battery as a share of the capacity.
  double charge() const { return charge_; }

 private:
  void solve();
  void solve_loads();

  HandwrittenConstants constants_;
  reference::Orbit orbit_;
  reference::OperationsPlan plan_;
  storage::Time time_;
  double charge_;
  Flows flows_;
};

/// Describes the telemetry points that the model has, in the order of its samples, as the
/// spacecraft's points of the same names.
std::vector<storage::ParameterDescriptor> handwritten_descriptors(std::string_view spacecraft);

}  // namespace reident::satcs
