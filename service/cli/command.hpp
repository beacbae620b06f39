// What the subcommands of `reident` have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace reident::cli {

/// Exit statuses of `reident`.
enum ExitCode : int {
  exit_done = 0,
  exit_failed = 1,      // the machine would not: a file that cannot be written, a full disk; or
                        // verify found damage
  exit_impossible = 2,  // the request cannot be met; one line says what would mend it
  exit_no_model = 3,    // the data give no model; the reason is printed
  exit_timed_out = 4,
};

/// A request that cannot be met: one line that says what is wrong and what would mend it.
struct Refusal {
  std::string message;
};

/// Prints "reident: <message>" on standard error. Returns exit_impossible.
int refuse(const Refusal& refusal);

/// Checks that an option's value is a whole number above 0.
CLI::Validator above_zero();

/// The digits of a whole number, 0 or more, with nothing around them.
std::optional<std::int64_t> whole_number(std::string_view text);

}  // namespace reident::cli
