#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/file_errors.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/operations/protected_telemetry.hpp"
#include "service/support/progress.hpp"
#include "service/support/size_text.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"
#include "storage/care/retention.hpp"

namespace reident::cli::retain_verb {
namespace {

using storage::ProtectedRange;
using storage::RetentionReport;
using storage::RetentionRule;

struct Arguments {
  DatabaseOptions database;
  std::string file;
  std::optional<std::string> keep, max_size;
  bool dry_run = false;
  bool including_versions = false;
  bool json = false;
};

struct Request {
  RetentionRule rule;
  std::optional<Config> config;
};

std::variant<Request, Refusal> request_of(const Arguments& arguments) {
  Request request;
  if (arguments.database.config) {
    auto chosen = chosen_config(arguments.database.config);
    if (auto* refusal = std::get_if<Refusal>(&chosen)) return *refusal;
    request.config = std::move(std::get<std::optional<Config>>(chosen));
    request.rule = {request.config->keep, request.config->max_size};
  }
  if (arguments.keep) {
    const auto keep = parse_duration(*arguments.keep);
    if (!keep || *keep <= 0)
      return Refusal{
          fmt::format("--keep {} is no time; write it with its unit, as 400d", *arguments.keep)};
    request.rule.keep = keep;
  }
  if (arguments.max_size) {
    const auto bytes = parse_size(*arguments.max_size);
    if (!bytes || *bytes == 0)
      return Refusal{fmt::format("--max-size {} is no size; write it with its unit, as 200GB",
                                 *arguments.max_size)};
    request.rule.max_bytes = bytes;
  }
  if (request.rule.keeps_everything())
    return Refusal{
        "nothing says what to keep: name --keep TIME or --max-size SIZE, or a configuration with "
        "keep or max_size in [archive] by --config FILE"};
  return request;
}

std::vector<ProtectedRange> protection(const Arguments& arguments, const Request& request,
                                       storage::Database& database, storage::Time now) {
  std::vector<ProtectedRange> all;
  const storage::Archive archive(database);
  const storage::Registry registry(database);
  if (!arguments.including_versions) all = telemetry_of_versions(archive, registry);
  if (request.config) {
    const auto needed = telemetry_still_needed(archive, *request.config, now);
    all.insert(all.end(), needed.begin(), needed.end());
  }
  return all;
}

void print(const Arguments& arguments, const RetentionReport& report) {
  const auto time = [](const std::optional<storage::Time>& at) {
    return at ? nlohmann::ordered_json(time_text(*at)) : nlohmann::ordered_json();
  };
  if (arguments.json) {
    const nlohmann::ordered_json object = {{"dry_run", arguments.dry_run},
                                           {"samples", report.samples},
                                           {"chunks", report.chunks},
                                           {"bytes", report.bytes},
                                           {"first", time(report.first)},
                                           {"last", time(report.last)},
                                           {"protected_chunks", report.protected_chunks},
                                           {"bytes_in_use", report.bytes_in_use},
                                           {"too_large", report.too_large}};
    fmt::print("{}\n", object.dump());
    return;
  }
  const char* verb = arguments.dry_run ? "would remove" : "removed";
  if (report.chunks == 0)
    fmt::print("{} nothing", verb);
  else
    fmt::print("{} {} samples ({}) from {} to {}", verb, report.samples, size_text(report.bytes),
               time_text(*report.first), time_text(*report.last));
  if (report.protected_chunks > 0)
    fmt::print("; {} chunks stay, {} need them", report.protected_chunks,
               arguments.including_versions ? "the next windows" : "versions or the next windows");
  fmt::print("; {} in use{}\n", size_text(report.bytes_in_use),
             report.too_large ? ", more than asked for: nothing else may go" : "");
}

int plan(const Arguments& arguments, const Request& request) {
  storage::Database database(arguments.file, storage::Database::Mode::read_only);
  const storage::Time now = utc_now();
  print(arguments,
        plan_retention(database, request.rule, protection(arguments, request, database, now), now));
  return exit_done;
}

int remove(const Arguments& arguments, const Request& request) {
  const StopSignal stop;
  storage::Database database(arguments.file, storage::Database::Mode::update);
  storage::Archive archive(database);
  archive.compact();
  const storage::Time now = utc_now();
  const auto kept = protection(arguments, request, database, now);
  const RetentionReport planned = plan_retention(database, request.rule, kept, now);
  storage::Retention retention(archive, request.rule, kept, now);
  Progress bar;
  bool more = true;
  while (more && !stop.token().stop_requested()) {
    more = retention.step();
    bar.update(static_cast<double>(retention.report().chunks) /
                   static_cast<double>(std::max<std::uint64_t>(1, planned.chunks)),
               fmt::format("{} samples removed", retention.report().samples));
  }
  bar.clear();
  print(arguments, retention.report());
  if (more) print_error("reident: stopped; the same command goes on where it ended");
  return more ? exit_failed : exit_done;
}

int run(Arguments& arguments) {
  const auto path = database_path(arguments.database);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  arguments.file = std::get<std::filesystem::path>(path).string();
  const auto request = request_of(arguments);
  if (const auto* refusal = std::get_if<Refusal>(&request)) return refuse(*refusal);
  return refusing_what_cannot_be([&] {
    try {
      return arguments.dry_run ? plan(arguments, std::get<Request>(request))
                               : remove(arguments, std::get<Request>(request));
    } catch (const storage::Error& error) {
      if (error.kind() != storage::Error::Kind::locked) throw;
      return refuse(
          {fmt::format("{}; a service that runs removes by keep and max_size of its own "
                       "configuration",
                       error.what())});
    }
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_file_argument(command, arguments->database, "database, which no service may hold");
  command.add_option("--keep", arguments->keep,
                     "remove what is older than this before the spacecraft's newest telemetry, "
                     "as 400d");
  command.add_option("--max-size", arguments->max_size,
                     "remove the oldest until no more than this is in use, as 200GB");
  command.add_flag("--dry-run", arguments->dry_run,
                   "say what would be removed, and remove nothing");
  command.add_flag("--including-versions", arguments->including_versions,
                   "also what published versions were identified from: they cannot be reproduced "
                   "any more");
  command.add_flag("--json", arguments->json, "one JSON object with what was removed");
  command.footer("Example:\n  reident retain reident.db --keep 400d --dry-run");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"retain",
                                   "Remove the oldest telemetry of a database, by age or by size",
                                   WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::retain_verb
