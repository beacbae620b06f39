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

/// Sets `time` to what an option such as "--at" names; one that was not given leaves it.
std::optional<Refusal> read_telemetry_time(std::string_view flag,
                                           const std::optional<std::string>& text,
                                           storage::Time& time);

/// The range that was asked for; a bound that is left out is that of `otherwise`.
std::variant<storage::TimeRange, Refusal> range_of(const RangeOptions& options,
                                                   storage::TimeRange otherwise);

}  // namespace reident::cli
