#include "tests/trust/scenario.hpp"

#include <array>
#include <optional>
#include <random>
#include <stdexcept>

#include "service/model/derived_inputs.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"

namespace reident::trust {
namespace {

using satcs::Fault;
using satcs::FaultKind;
using satcs::reference::LifeEvent;
using satcs::reference::LifeKind;

constexpr storage::Time first_start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
constexpr Duration hour = 3'600'000'000'000;
constexpr Duration day = 24 * hour;
constexpr Duration telemetry_days = 31;
constexpr int faults_of_a_life = 4;

/// A life without its times.
struct LifePlan {
  std::string_view name;
  struct Event {
    LifeKind kind;
    double magnitude;
    int unit;
    double begin_day;  // after the time of the change
    double days;       // 0: a step, or for good
  };
  std::vector<Event> events;
  std::vector<std::string> equipment;
  int start_day = 0;  // after 2017-07-01
};

std::vector<LifePlan> life_plans() {
  using enum LifeKind;
  return {
      {"none", {}, {"BDR"}},
      {"none", {}, {"BAT1"}, 120},
      {"none", {}, {"MEA"}, 240},
      {"none", {}, {"SAG2", "DCDC3"}, 300},
      {"array_degradation", {{array_degradation, 0.05, 0, 0, 12}}, {"SAG2"}},
      {"array_degradation", {{array_degradation, 0.20, 3, 0, 0}}, {"MEA", "SAG2"}, 90},
      {"capacity_fade", {{capacity_fade, 0.10, 0, 0, 12}}, {"BAT1"}, 30},
      {"capacity_fade", {{capacity_fade, 0.30, 1, 0, 0}}, {"BAT1"}, 200},
      {"capacity_fade", {{capacity_fade, 0.50, 1, 0, 0}}, {"BAT1"}},
      {"rising_resistance", {{rising_resistance, 0.5, 0, 0, 12}}, {"BAT1"}},
      {"rising_resistance", {{rising_resistance, 2.0, 0, 0, 12}}, {"BAT1"}, 150},
      {"rising_resistance", {{rising_resistance, 1.0, 1, 0, 0}}, {"BAT1"}, 60},
      {"efficiency_drift", {{efficiency_drift, 0.3, 0, 0, 12}}, {"BDR"}},
      {"efficiency_drift", {{efficiency_drift, 1.0, 0, 0, 0}}, {"BDR"}, 270},
      {"efficiency_drift", {{efficiency_drift, 3.0, 0, 0, 10}}, {"BDR"}, 180},
      {"lost_string", {{lost_string, 1, 1, 0, 0}}, {"BAT1"}},
      {"lost_string", {{lost_string, 6, 1, 0, 0}}, {"BAT1"}, 330},
      {"lost_string", {{lost_string, 3, 3, 0, 0}}, {"SAG2"}},
      {"failed_cell", {{failed_cell, 1, 1, 0, 0}}, {"BAT1"}},
      {"failed_cell", {{failed_cell, 2, 1, 0, 0}}, {"BDR", "BAT1"}, 100},
      {"failed_cell", {{failed_cell, 2, 2, 0, 0}}, {"BAT2"}},
      {"redundant_charger", {{redundant_charger, 1, 1, 0, 0}}, {"CHC1"}, 45},
      {"redundant_charger", {{redundant_charger, 1, 1, 0, 5}}, {"BAT1"}},
      {"safe_mode", {{safe_mode, 1, 0, 0, 1}}, {"DIST"}},
      {"safe_mode", {{safe_mode, 1, 0, 0, 3}}, {"MEA"}, 210},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"BAT1"}},
      {"quiet", {{quiet, 1, 0, 0, 7}}, {"DIST"}, 75},
      {"ageing",
       {{array_degradation, 0.03, 0, 0, 12},
        {capacity_fade, 0.08, 0, 0, 12},
        {rising_resistance, 0.4, 0, 0, 12},
        {efficiency_drift, 0.3, 0, 0, 12}},
       {"BDR", "BAT1"}},
      {"ageing",
       {{array_degradation, 0.08, 0, 0, 12},
        {capacity_fade, 0.15, 0, 0, 12},
        {rising_resistance, 0.8, 0, 0, 12},
        {efficiency_drift, 0.6, 0, 0, 12}},
       {"MEA"},
       160},
      {"two_failures",
       {{failed_cell, 1, 1, 0, 0}, {efficiency_drift, 1.0, 0, 6, 0}},
       {"BDR", "BAT1"},
       20},
      {"failure_in_safe_mode", {{safe_mode, 1, 0, -0.2, 1}, {lost_string, 4, 4, 0, 0}}, {"MEA"}},
      {"failure_in_safe_mode",
       {{safe_mode, 1, 0, -0.2, 1}, {failed_cell, 1, 1, 0, 0}},
       {"BAT1"},
       130},
      {"converter_drift", {{converter_drift, 1.0, 3, 0, 0}}, {"DCDC3"}},
      {"converter_drift", {{converter_drift, 0.5, 0, 0, 12}}, {"DCDC3"}, 250},
      {"redundant_heater", {{redundant_heater, 1, 1, 0, 0}}, {"BAT1"}, 10},
  };
}

/// Which of an equipment's parameters a fault is about.
enum class Role { none, output, first_input, last_input };

/// A fault without its time.
struct FaultPlan {
  FaultKind kind;
  Role role = Role::none;
  std::optional<double> magnitude = {};  // of a sensor's: in shares of the usual one
};

std::vector<FaultPlan> fault_plans() {
  using enum FaultKind;
  std::vector<FaultPlan> plans;
  constexpr std::array roles{Role::output, Role::first_input, Role::last_input};
  for (const FaultKind kind : {bias_step, drifting_bias, noise_burst, spikes})
    for (const Role role : roles)
      for (const double share : {0.5, 2.0}) plans.push_back({kind, role, share});
  for (const FaultKind kind : {stuck, stops, wrong_calibration, swapped})
    for (const Role role : roles) plans.push_back({kind, role});
  for (const double share : {0.05, 0.2, 0.5}) plans.push_back({wrong_validity, Role::none, share});
  for (const double share : {0.1, 0.5}) plans.push_back({frames_lost, Role::none, share});
  for (const double share : {0.3, 0.8}) plans.push_back({passes_lost, Role::none, share});
  for (const FaultKind kind : {backwards_playback, two_stations, two_stamping_stations, time_jump,
                               duplicated_day, repeated_day, simulated_as_real})
    plans.push_back({kind});
  return plans;
}

/// Uniform numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

storage::Time after(storage::Time time, double days) {
  constexpr Duration grid = 8'000'000'000;
  return time + static_cast<Duration>(days * static_cast<double>(day)) / grid * grid;
}

std::vector<LifeEvent> events_of(const LifePlan& plan, storage::Time change) {
  std::vector<LifeEvent> events;
  for (const LifePlan::Event& event : plan.events) {
    const storage::Time begin = after(change, event.begin_day);
    events.push_back({event.kind, begin, after(begin, event.days), event.magnitude, event.unit});
  }
  return events;
}

/// Usual magnitude of a sensor's fault, in shares of the span between the parameter's limits.
double usual_share(FaultKind kind) {
  switch (kind) {
    case FaultKind::drifting_bias:
      return 0.05;
    case FaultKind::spikes:
      return 0.20;
    default:
      return 0.02;
  }
}

const satcs::reference::TelemetryPoint& point_of(const std::string& parameter) {
  for (const auto& point : satcs::reference::telemetry_points())
    if (point.name == parameter) return point;
  throw std::logic_error("no telemetry point " + parameter);
}

double span_of(const std::string& parameter) {
  const auto& sensor = point_of(parameter).sensor;
  return sensor.high - sensor.low;
}

bool is_digital(const std::string& parameter) {
  return point_of(parameter).kind == storage::ParameterKind::digital;
}

std::string parameter_of(Role role, const EquipmentConfig& equipment) {
  if (role == Role::output) return equipment.outputs.front();
  const auto inputs = InputExpressions(equipment.inputs, equipment.derived).parameters();
  return role == Role::first_input ? inputs.front() : inputs.back();
}

/// Half of the faults fall on the change, the others fault apart from it, before or after.
satcs::Fault fault_of(const FaultPlan& plan, const EquipmentConfig& equipment, storage::Time start,
                      storage::Time change, bool on_the_change, Dice& dice) {
  constexpr std::array days{0.15, 1.0, 3.0, 6.0};
  const double lasts = days[dice.below(days.size())];
  storage::Time begin = after(change, dice.between(-1.0, 1.0));
  if (!on_the_change)
    begin =
        dice.below(2) == 0 ? after(start, dice.between(2, 6)) : after(change, dice.between(6, 9));
  Fault fault{plan.kind, {begin, after(begin, lasts)}, {}, {}, plan.magnitude, dice.below(1 << 20)};
  if (plan.role == Role::none) return fault;
  fault.parameter = parameter_of(plan.role, equipment);
  if (plan.kind == FaultKind::swapped)
    fault.other =
        parameter_of(plan.role == Role::output ? Role::first_input : Role::output, equipment);
  // A switch has no analog sensor to fault.
  else if (plan.kind != FaultKind::stops && is_digital(fault.parameter))
    fault.parameter = parameter_of(Role::output, equipment);
  if (plan.magnitude)
    fault.magnitude = *plan.magnitude * usual_share(plan.kind) * span_of(fault.parameter);
  return fault;
}

const EquipmentConfig& named(const SpacecraftConfig& spacecraft, const std::string& name) {
  for (const EquipmentConfig& equipment : spacecraft.equipment)
    if (equipment.name == name) return equipment;
  throw std::invalid_argument("the configuration has no equipment " + name);
}

}  // namespace

std::vector<LifeGroup> all_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw) {
  constexpr std::uint64_t seeds_of_a_draw = 10'000;  // even: no seed of a draw is held out
  const std::vector<LifePlan> lives = life_plans();
  const std::vector<FaultPlan> faults = fault_plans();
  std::vector<LifeGroup> groups;
  int number = 0;
  for (std::uint64_t half = 0; half < (draw == 0 ? 2 : 1); ++half) {
    // Walks through all faults, far apart from one to the next.
    constexpr std::size_t stride = 31;
    std::size_t next_fault = 5 * half;
    for (std::size_t i = 0; i < lives.size(); ++i) {
      const LifePlan& life = lives[i];
      LifeGroup group;
      group.seed = seeds_of_a_draw * draw + 2 * (i + 1) + half;
      group.life = life.name;
      group.equipment = life.equipment;
      Dice dice(group.seed);
      group.start = after(first_start, life.start_day + static_cast<double>(dice.below(20)));
      group.duration = telemetry_days * day;
      const storage::Time change = after(group.start, dice.between(12, 15));
      group.events = events_of(life, change);
      group.scenarios.push_back({++number, "none", {}});
      for (int k = 0; k < faults_of_a_life; ++k, next_fault += stride) {
        const FaultPlan& plan = faults[next_fault % faults.size()];
        const EquipmentConfig& equipment =
            named(spacecraft, life.equipment[dice.below(life.equipment.size())]);
        group.scenarios.push_back(
            {++number,
             std::string(name(plan.kind)),
             {fault_of(plan, equipment, group.start, change, k % 2 == 0, dice)}});
      }
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

bool is_of_the_handful(const Scenario& scenario) {
  return scenario.number % 71 == 36;
}

LifeGroup short_group() {
  LifeGroup group;
  group.seed = 1000;
  group.life = "failed_cell";
  group.equipment = {"BAT1"};
  group.start = first_start;
  group.duration = 5 * day;
  const storage::Time change = after(group.start, 2.2);
  group.events = {{LifeKind::failed_cell, change, change, 2, 1}};
  group.scenarios = {{0,
                      "bias_step",
                      {{FaultKind::bias_step,
                        {group.start + 24 * hour, group.start + 30 * hour},
                        "V_BAT1",
                        {},
                        1.0,
                        1}}}};
  return group;
}

}  // namespace reident::trust
