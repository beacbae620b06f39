// A scenario as command lines, for those who run it with the real processes.
#pragma once

#include <string>
#include <vector>

#include "tests/trust/scenario.hpp"

namespace reident::trust {

/// Arguments of satcs-reference that make the telemetry of a scenario, but for where it goes and
/// how fast. It comes each second; every eighth frame is one of the suite's.
struct Recipe {
  std::vector<std::string> simulator;   // the hand-written one's, which is sent first
  std::vector<std::string> spacecraft;  // with the faults
};
Recipe recipe_of(const LifeGroup& group, const Scenario& scenario);

}  // namespace reident::trust
