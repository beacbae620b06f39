#include <chrono>
#include <cstdio>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/verb.hpp"
#include "service/dds/dds.hpp"
#include "service/model/status_json.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::status_verb {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double default_timeout_s = 10;
constexpr double max_timeout_s = 1e6;
constexpr auto time_of_others = std::chrono::milliseconds(300);  // for a last heartbeat to come

struct Arguments {
  std::optional<std::string> config;
  std::optional<std::uint32_t> domain;
  std::optional<std::string> partition;
  std::string service;
  std::string wait;
  double timeout_s = default_timeout_s;
  bool json = false;
};

/// Idle in two heartbeats, and nothing came in between them.
bool stayed_idle(const ServiceStatus& before, const ServiceStatus& now) {
  return is_idle(before) && is_idle(now) && before.time != now.time &&
         before.started == now.started && before.frames_received == now.frames_received &&
         before.samples_stored == now.samples_stored && before.attempts == now.attempts;
}

/// The last heartbeats of services, by name and start.
using Heard = std::map<std::pair<std::string, storage::Time>, ServiceStatus>;

/// Listens until the wish is met, and a moment more for others. Empty when the time ran out;
/// `heard` is then the last heartbeat, if there was one. `all` gets those of every service.
std::optional<ServiceStatus> listen(dds::Participant& participant, const Arguments& arguments,
                                    std::optional<ServiceStatus>& heard, Heard& all) {
  dds::Reader<ServiceStatus> reader(participant);
  dds::WaitSet waits(participant);
  waits.attach(reader);
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(arguments.timeout_s));
  std::optional<ServiceStatus> met;
  std::optional<ServiceStatus> before;  // sent since: the first that comes is from before
  const auto look = [&](ServiceStatus&& status) {
    if (!arguments.service.empty() && status.service != arguments.service) return;
    all[{status.service, status.started}] = status;
    // The first of several services is followed.
    if (heard && heard->service != status.service) return;
    if (!met && (arguments.wait.empty() || (before && stayed_idle(*before, status)))) met = status;
    if (heard) before = status;
    heard = std::move(status);
  };
  while (!met) {
    const auto left = deadline - Clock::now();
    if (left <= Clock::duration::zero()) break;
    if (waits.wait(left)) reader.take(64, look);
  }
  const auto others_until = Clock::now() + time_of_others;
  while (met && Clock::now() < others_until)
    if (waits.wait(others_until - Clock::now())) reader.take(64, look);
  return met;
}

std::string newest_text(const ServiceStatus& status) {
  return status.newest_telemetry == 0 ? "none" : time_text(status.newest_telemetry);
}

void print_json(const ServiceStatus& status, const Heard& others) {
  nlohmann::ordered_json object = status_json(status);
  object["others"] = nlohmann::ordered_json::array();
  for (const auto& [key, other] : others) object["others"].push_back(status_json(other));
  fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void print_text(const ServiceStatus& status) {
  fmt::print("service {} ({}), up since {}, {}\n", status.service, status.program_version,
             time_text(status.started), is_idle(status) ? "idle" : "at work");
  if (!status.pair.empty())
    fmt::print("pair {}: {} in term {}, with {}{}\n", status.pair, status.role, status.term,
               status.partner.empty() ? "nobody" : status.partner,
               status.lag < 0 ? "" : fmt::format(", {} rows of the registry behind", status.lag));
  fmt::print("newest telemetry {}\n", newest_text(status));
  if (const auto days = certificate_days(status))
    fmt::print("certificate until {} ({} days)\n", time_text(status.certificate_end), *days);
  Table table({{"count"}, {"", Table::Align::right}});
  for (const auto& [name, count] : counts(status)) table.add({name, fmt::format("{}", count)});
  fmt::print("{}", table.text(0));
  if (!status.last_error.empty()) fmt::print("last error: {}\n", status.last_error);
  if (!status.failing_champions.empty())
    fmt::print("champions that fail: {} (reident overview says why)\n", status.failing_champions);
  for (const std::string& alarm : lines_of(status.alarms)) fmt::print("alarm: {}\n", alarm);
}

int report_timeout(const dds::Endpoint& endpoint, const Arguments& arguments,
                   const std::optional<ServiceStatus>& heard) {
  if (heard)
    print_error(
        "reident: {} was not idle within {:g} s: {} frames queued, {} windows pending, {} "
        "attempts; give it more --timeout",
        heard->service, arguments.timeout_s, heard->queue_length, heard->windows_pending,
        heard->attempts);
  else
    print_error(
        "reident: no {} was heard on domain {}, partition {} within {:g} s; check that "
        "reidentd runs and the domain and partition are its own{}",
        arguments.service.empty() ? "service" : "service " + arguments.service, endpoint.domain,
        endpoint.partition, arguments.timeout_s, why_unheard(endpoint, arguments.config));
  return exit_timed_out;
}

int run(const Arguments& arguments) {
  const auto chosen = chosen_endpoint(arguments.config, arguments.domain, arguments.partition);
  if (const auto* refusal = std::get_if<Refusal>(&chosen)) return refuse(*refusal);
  const dds::Endpoint& endpoint = std::get<dds::Endpoint>(chosen);
  dds::Participant participant(endpoint);
  std::optional<ServiceStatus> heard;
  Heard others;
  const auto status = listen(participant, arguments, heard, others);
  if (!heard && participant.misses_security()) return refuse(missing_security(endpoint));
  if (!status) return report_timeout(endpoint, arguments, heard);
  others.erase({status->service, status->started});
  if (arguments.json) {
    print_json(*status, others);
    return exit_done;
  }
  print_text(*status);
  for (const auto& [key, other] : others) {
    fmt::print("\nanother service of the partition:\n");
    print_text(other);
  }
  return exit_done;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option(
      "--config", arguments->config,
      fmt::format("configuration with domain and partition ({})", default_config_file));
  command.add_option("--domain", arguments->domain, "DDS domain")->check(CLI::Range(0, 230));
  command.add_option("--partition", arguments->partition, "DDS partition");
  command.add_option("--service", arguments->service, "this service alone, by its name");
  command.add_option("--wait", arguments->wait, "idle: until all that came in is dealt with")
      ->check(CLI::IsMember({"idle"}));
  command.add_option("--timeout", arguments->timeout_s, "seconds to listen")
      ->check(CLI::Range(0.0, max_timeout_s))
      ->capture_default_str();
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Example:\n  reident status --config reident.toml --wait idle --timeout 60\n"
      "Exit status: 4 when nothing was heard in time, or the service was not idle.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"status", "Ask over DDS what the running service does",
                                   WorksOn::service, declare});

}  // namespace

}  // namespace reident::cli::status_verb
