#include "tests/trust/scenario.hpp"

#include <array>
#include <optional>
#include <random>
#include <stdexcept>

#include "service/model/derived_inputs.hpp"
#include "service/satcs/reference/telemetry_point.hpp"
#include "tests/trust/plans.hpp"

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
constexpr std::size_t faults_of_a_life = 4;

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

const satcs::reference::PointInfo& point_of(const std::string& parameter) {
  if (const auto* point = satcs::find_point(parameter)) return *point;
  throw std::logic_error("no telemetry point " + parameter);
}

double span_of(const std::string& parameter) {
  const auto& sensor = point_of(parameter).sensor;
  return sensor.high - sensor.low;
}

bool is_digital(const std::string& parameter) {
  return point_of(parameter).digital();
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
  const double drawn = days[dice.below(days.size())];
  const double lasts = plan.days.value_or(drawn);
  storage::Time begin = after(change, dice.between(-1.0, 1.0));
  if (plan.days && on_the_change)  // the change falls into it
    begin = after(change, -lasts * dice.between(0.1, 0.9));
  else if (!on_the_change)
    begin =
        dice.below(2) == 0 ? after(start, dice.between(2, 6)) : after(change, dice.between(6, 9));
  Fault fault{plan.kind, {begin, after(begin, lasts)}, {}, {}, plan.magnitude, dice.below(1 << 20)};
  if (plan.role == Role::none) return fault;  // a magnitude is a share, as it is
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

/// A life with its times, and the scenario without a fault.
LifeGroup group_of(const LifePlan& life, satcs::Family family, std::uint64_t seed, Dice& dice,
                   storage::Time& change) {
  LifeGroup group;
  group.family = family;
  group.seed = seed;
  group.life = life.name;
  group.equipment = life.equipment;
  group.start = after(first_start, life.start_day + static_cast<double>(dice.below(20)));
  group.duration = telemetry_days * day;
  change = after(group.start, dice.between(12, 15));
  group.events = events_of(life, change);
  group.scenarios.push_back({0, "none", {}});
  return group;
}

void add_fault(LifeGroup& group, const FaultPlan& plan, const SpacecraftConfig& spacecraft,
               storage::Time change, bool on_the_change, Dice& dice) {
  const EquipmentConfig& equipment =
      named(spacecraft, group.equipment[dice.below(group.equipment.size())]);
  group.scenarios.push_back(
      {0,
       std::string(name(plan.kind)),
       {fault_of(plan, equipment, group.start, change, on_the_change, dice)}});
}

constexpr std::uint64_t seeds_of_a_draw = 10'000;
/// Each life of the power subsystem comes so often, with other faults.
constexpr std::uint64_t rounds = 2;

// A walk through all faults, far apart from one to the next.
constexpr std::size_t stride = 31;

std::vector<LifeGroup> power_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw) {
  const std::vector<LifePlan> lives = life_plans(satcs::Family::power);
  const std::vector<FaultPlan> faults = fault_plans();
  std::vector<LifeGroup> groups;
  for (std::uint64_t round = 0; round < rounds; ++round) {
    std::size_t next_fault = 5 * round;
    for (std::size_t i = 0; i < lives.size(); ++i) {
      const std::uint64_t seed = seeds_of_a_draw * draw + rounds * (i + 1) + round;
      Dice dice(seed);
      storage::Time change = 0;
      LifeGroup group = group_of(lives[i], satcs::Family::power, seed, dice, change);
      for (std::size_t k = 0; k < faults_of_a_life; ++k, next_fault += stride)
        add_fault(group, faults[next_fault % faults.size()], spacecraft, change, k % 2 == 0, dice);
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

std::vector<LifeGroup> platform_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw) {
  constexpr std::uint64_t first_seed = 1'000'001;
  const std::vector<LifePlan> lives = life_plans(satcs::Family::platform);
  std::vector<FaultPlan> any_fault = fault_plans();
  std::erase_if(any_fault,  // of which there are enough
                [](const FaultPlan& plan) { return plan.kind == FaultKind::bias_step; });
  std::vector<LifeGroup> groups;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    const std::uint64_t seed = first_seed + seeds_of_a_draw * draw + 2 * i;
    Dice dice(seed);
    storage::Time change = 0;
    LifeGroup group = group_of(lives[i], satcs::Family::platform, seed, dice, change);
    std::vector<FaultPlan> faults = platform_faults(i);
    faults.push_back(any_fault[(5 + i * stride) % any_fault.size()]);
    for (std::size_t k = 0; k < faults.size(); ++k)
      add_fault(group, faults[k], spacecraft, change, faults[k].on_the_change.value_or(i % 2 == 0),
                dice);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace

std::vector<LifeGroup> all_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw,
                                  satcs::Family family) {
  std::vector<LifeGroup> groups = family == satcs::Family::power
                                      ? power_groups(spacecraft, draw)
                                      : platform_groups(spacecraft, draw);
  int number = family == satcs::Family::power ? 0 : platform_numbers;
  for (LifeGroup& group : groups)
    for (Scenario& scenario : group.scenarios) scenario.number = ++number;
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
