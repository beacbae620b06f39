// What happens to a spacecraft and to its telemetry while the service looks on.
//
// Scenarios come in groups of one life: the plant runs once for a group, and each scenario of it
// has other faults. Numbers, seeds and times are a function of this file alone.
#pragma once

#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/satcs/family.hpp"
#include "service/satcs/faults/fault_injector.hpp"
#include "service/satcs/reference/reference_life.hpp"

namespace reident::trust {

struct Scenario {
  int number = 0;
  std::string fault = "none";  // kind of fault, as the table names it
  std::vector<satcs::Fault> faults;
};

struct LifeGroup {
  satcs::Family family = satcs::Family::power;
  std::uint64_t seed = 0;  // of the operations plan, the sensors and the times
  std::string life = "none";
  std::vector<satcs::reference::LifeEvent> events;
  std::vector<std::string> equipment;  // of the suite's configuration
  storage::Time start = 0;
  Duration duration = 0;  // of the telemetry
  std::vector<Scenario> scenarios;
};

/// The hand-written simulator is compared with for so long after the start; its telemetry costs as
/// much as the spacecraft's.
inline constexpr Duration simulator_sends = 12 * 86'400'000'000'000;

/// Scenarios of the platform are numbered from here.
inline constexpr int platform_numbers = 1000;

/// All scenarios of a family, for the equipment of its configuration. Each `draw` has the same
/// plans with other seeds, dates and times: a rule that fits the draws it was made on shows it on
/// others. Draw 0 is that of the regression tests.
std::vector<LifeGroup> all_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw = 0,
                                  satcs::Family family = satcs::Family::power);

/// Those that go over real DDS too: every 71st, so that lives and faults are different ones. Five
/// are of the power subsystem, and three of the platform.
bool is_of_the_handful(const Scenario& scenario);

/// Number 0, for tests, and no part of the suite: five days in which a sensor faults and, later, a
/// battery's cells fail.
LifeGroup short_group();

}  // namespace reident::trust
