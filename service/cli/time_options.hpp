// --from and --to: the range of time that a command works on.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "service/cli/command.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::cli {

struct TimeOptions {
  std::optional<std::string> from, to;
};

/// `meaning` says what lies between them, such as "samples".
void add_time_options(CLI::App& command, TimeOptions& choice, const std::string& meaning);

/// Ends that were not given are those of `all`.
std::variant<storage::TimeRange, Refusal> chosen_range(const TimeOptions& choice,
                                                       storage::TimeRange all);

}  // namespace reident::cli
