// A site's instances as values of the Helm chart deploy/container/chart.
#pragma once

#include <string>

#include "service/config/fleet_table.hpp"

namespace reident::fleet {

/// Returns JSON, which Helm takes as YAML: `spacecraft`, as the chart's values.yaml says. Throws
/// what site_files() throws, and std::invalid_argument where Kubernetes has no such name or limit.
std::string helm_values(const Fleet& fleet);

}  // namespace reident::fleet
