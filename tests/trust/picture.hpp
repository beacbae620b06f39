// A scenario as one picture: for each equipment the output's truth and the error of what simulators
// ran, with publications, drift requests, life and faults.
#pragma once

#include <string>

#include "tests/trust/group_run.hpp"

namespace reident::trust {

/// A self-contained SVG document.
std::string picture(const ScenarioOutcome& outcome);

}  // namespace reident::trust
