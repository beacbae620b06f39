// Where the commands that only read look: in a database file, or with --remote at the running
// service.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "service/cli/command.hpp"
#include "service/cli/stored.hpp"
#include "service/history/readers.hpp"

namespace reident::cli {

struct HistoryAccessOptions {
  DatabaseOptions database;
  bool remote = false;
  std::optional<std::uint32_t> domain;
  std::optional<std::string> partition;
  std::optional<std::string> service;
  double timeout_s = 10;
  /// The program's own option, for --remote before the command.
  const CLI::Option* remote_before = nullptr;

  bool is_remote() const { return remote || (remote_before && remote_before->count() > 0); }
};

/// --remote, --domain, --partition, --service and --timeout.
void add_remote_options(CLI::App& command, HistoryAccessOptions& options);
/// Those, --database and --config.
void add_access_options(CLI::App& command, HistoryAccessOptions& options);

/// Options of a command whose first argument is the database and that takes a configuration for the
/// rest.
void add_archive_options(CLI::App& command, HistoryAccessOptions& options);
struct Readers {
  const history::HistoryReader& history;
  const history::TelemetryReader& telemetry;
};

/// Calls `work` with what the options name. A database that cannot be used, and what a service
/// cannot answer, is refused; exit_timed_out where no service answers.
int with_readers(const HistoryAccessOptions& options,
                 const std::function<int(const Readers&)>& work);

}  // namespace reident::cli
