// A range of telemetry on the command line.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "service/cli/command.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::cli {

/// --begin and --end of a range of telemetry.
struct RangeOptions {
  std::optional<std::string> begin, end;
};

void add_range_options(CLI::App& command, RangeOptions& options, const std::string& otherwise);

/// The range that was asked for; a bound that is left out is that of `otherwise`.
std::variant<storage::TimeRange, Refusal> range_of(const RangeOptions& options,
                                                   storage::TimeRange otherwise);

}  // namespace reident::cli
