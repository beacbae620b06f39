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

/// The digits of a whole number, 0 or more, with nothing around them.
std::optional<std::int64_t> whole_number(std::string_view text);

/// Each adds a subcommand whose callback leaves its exit status in `exit_code`.
void add_identify(CLI::App& app, int& exit_code);
void add_history(CLI::App& app, int& exit_code);
void add_show(CLI::App& app, int& exit_code);
void add_why(CLI::App& app, int& exit_code);
void add_reproduce(CLI::App& app, int& exit_code);
void add_backfill(CLI::App& app, int& exit_code);
void add_backup(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_export_model(CLI::App& app, int& exit_code);
void add_completeness(CLI::App& app, int& exit_code);
void add_at(CLI::App& app, int& exit_code);
/// approve, reject, withdraw, hold, release, rollback and identify-now.
void add_operator_commands(CLI::App& app, int& exit_code);
void add_check_config(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_plot(CLI::App& app, int& exit_code);
void add_simulators(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_retain(CLI::App& app, int& exit_code);
void add_version(CLI::App& app, int& exit_code);

}  // namespace reident::cli
