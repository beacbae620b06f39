// What `--regime` stands for, given the file.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "service/cli/command.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::cli {

/// Returns the conditions of the regimes (service/model/regime_inputs.hpp). A column that has more
/// values than 0 and another one gives a regime for each value but the most frequent one. Refuses a
/// column of more than eight values. Reads such a file to its end.
std::variant<std::vector<std::string>, Refusal> regimes_of(telemetry_file::TelemetryFile& file,
                                                           const std::vector<std::string>& regimes);

}  // namespace reident::cli
