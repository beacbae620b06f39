#include "service/cli/history_access.hpp"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/cli/service_choice.hpp"
#include "service/history/remote_readers.hpp"
#include "service/history/stored_readers.hpp"
#include "service/security/material.hpp"
#include "service/support/progress.hpp"
#include "service/support/terminal.hpp"

namespace reident::cli {
namespace {

constexpr double max_timeout_s = 1e6;
constexpr std::chrono::seconds silent_at_most{2};

struct Service {
  dds::Endpoint endpoint;
  std::string name;  // as the configuration has it; empty: any
};

std::variant<Service, Refusal> service_of(const HistoryAccessOptions& options) {
  if (options.database.database)
    return Refusal{
        fmt::format("--remote asks the running service and reads no file; leave out {}, "
                    "or --remote",
                    *options.database.database)};
  auto chosen = chosen_config(options.database.config);
  if (auto* refusal = std::get_if<Refusal>(&chosen)) return *refusal;
  Service service;
  service.endpoint.security = security::folder_of_environment();
  if (const auto& config = std::get<std::optional<Config>>(chosen))
    service = {endpoint_of(*config), addressee(*config)};
  else if (!options.domain && !options.partition)
    return Refusal{
        fmt::format("there is no {} here; name the service's configuration with --config FILE, or "
                    "its DDS domain and partition",
                    default_config_file)};
  service.endpoint.domain = options.domain.value_or(service.endpoint.domain);
  service.endpoint.partition = options.partition.value_or(service.endpoint.partition);
  return service;
}

std::chrono::milliseconds timeout_of(const HistoryAccessOptions& options) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(options.timeout_s));
}

int with_service(const Service& service, const HistoryAccessOptions& options,
                 const std::function<int(const Readers&)>& work) {
  dds::Participant participant(service.endpoint);
  Progress line;
  const auto begun = Progress::Clock::now();
  history::RemoteHistory remote(participant, service.name, [&](bool is_waiting) {
    const std::chrono::duration<double> waited = Progress::Clock::now() - begun;
    if (!is_waiting)
      line.clear();
    else if (waited >= silent_at_most)
      line.update(fmt::format("asking {} for {:.0f} s", service.name, waited.count()));
  });
  const history::RemoteRows rows(remote, timeout_of(options));
  try {
    return work({history::RemoteHistoryReader(rows), history::RemoteTelemetryReader(rows)});
  } catch (const history::Error& error) {
    if (error.kind() == history::Error::Kind::refused) return refuse({error.what()});
    print_error(
        "reident: {} on domain {}, partition {}; check that reidentd runs and the domain "
        "and partition are its own",
        error.what(), service.endpoint.domain, service.endpoint.partition);
    return exit_timed_out;
  }
}

}  // namespace

void add_remote_options(CLI::App& command, HistoryAccessOptions& options) {
  options.remote_before = command.get_parent()->get_option("--remote");
  command.add_flag("--remote", options.remote,
                   "ask the running service over DDS instead of reading a file");
  command.add_option("--domain", options.domain, "DDS domain, with --remote")
      ->check(CLI::Range(0, 230));
  command.add_option("--partition", options.partition, "DDS partition, with --remote");
  add_service_option(command, options.service);
  command.add_option("--timeout", options.timeout_s, "seconds for each answer, with --remote")
      ->check(CLI::Range(0.0, max_timeout_s))
      ->capture_default_str();
}

void add_access_options(CLI::App& command, HistoryAccessOptions& options) {
  add_database_options(command, options.database);
  add_remote_options(command, options);
}

void add_archive_options(CLI::App& command, HistoryAccessOptions& options) {
  command.add_option("archive,--database,--db", options.database.database,
                     "database of the service");
  command.add_option("--config", options.database.config,
                     fmt::format("configuration with the equipment, the database, and the "
                                 "service's DDS domain and partition ({})",
                                 default_config_file));
  add_remote_options(command, options);
}

int with_readers(const HistoryAccessOptions& options,
                 const std::function<int(const Readers&)>& work) {
  if (!options.is_remote()) {
    if (options.domain || options.partition || options.service)
      return refuse(
          {"--domain, --partition and --service say which service is asked; add "
           "--remote"});
    return with_database(options.database, [&work](storage::Database& database) {
      return work({history::StoredHistory(database), history::StoredTelemetry(database)});
    });
  }
  auto found = service_of(options);
  if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
  Service& service = std::get<Service>(found);
  auto chosen =
      chosen_service(service.endpoint, options.service, service.name, timeout_of(options));
  if (const auto* refusal = std::get_if<Refusal>(&chosen)) return refuse(*refusal);
  service.name = std::get<ServiceStatus>(std::move(chosen)).service;
  return with_service(service, options, work);
}

}  // namespace reident::cli
