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

/// Half of the suite is held out of every tuning: nobody looks at its scenarios one by one.
enum class Half { tuned, held_out };

struct Scenario {
  int number = 0;
  std::string fault = "none";  // kind of fault, as the table names it
  std::vector<satcs::Fault> faults;
};

struct LifeGroup {
  satcs::Family family = satcs::Family::power;
  std::uint64_t seed = 0;  // of the operations plan, the sensors and the times; odd: held out
  std::string life = "none";
  std::vector<satcs::reference::LifeEvent> events;
  std::vector<std::string> equipment;  // of the suite's configuration
  storage::Time start = 0;
  Duration duration = 0;  // of the telemetry
  std::vector<Scenario> scenarios;

  Half half() const { return seed % 2 == 1 ? Half::held_out : Half::tuned; }
};

/// The hand-written simulator is compared with for so long after the start; its telemetry costs as
/// much as the spacecraft's.
inline constexpr Duration simulator_sends = 12 * 86'400'000'000'000;

/// Scenarios of the platform are numbered from here.
inline constexpr int platform_numbers = 1000;

/// All of the suite of a family, for the equipment of its configuration. With `draw` above 0 the
/// plans of its tuned half, numbered as there, with other seeds, dates and times: rules that are
/// made on few lives fit these, and other lives show it. The platform has no tuned half. It is held
/// out as a whole, in each draw.
std::vector<LifeGroup> all_groups(const SpacecraftConfig& spacecraft, std::uint64_t draw = 0,
                                  satcs::Family family = satcs::Family::power);

/// Those that go over real DDS too: every 71st, so that lives and faults are different ones. Two
/// are tuned, three are held out, and three are of the platform.
bool is_of_the_handful(const Scenario& scenario);

/// Number 0, for tests, and no part of the suite: five days in which a sensor faults and, later, a
/// battery's cells fail.
LifeGroup short_group();

}  // namespace reident::trust
