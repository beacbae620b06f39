#include "storage/care/backup.hpp"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/file_errors.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/support/progress.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::backup_verb {
namespace {

struct Arguments {
  DatabaseOptions database;
  std::string file, copy;
  storage::BackupOptions options;
  bool json = false;
};

void print(const storage::BackupReport& report, bool json) {
  const std::optional<std::string> newest =
      report.newest ? std::optional(time_text(*report.newest)) : std::nullopt;
  if (json) {
    nlohmann::ordered_json object = {{"copy", report.copy.string()},
                                     {"bytes", report.bytes},
                                     {"shards", report.shards},
                                     {"shard_bytes", report.shard_bytes},
                                     {"samples", report.samples},
                                     {"versions", report.versions},
                                     {"newest", nullptr}};
    if (newest) object["newest"] = *newest;
    fmt::print("{}\n", object.dump());
    return;
  }
  fmt::print("{}: {} bytes, {} samples{}, {} versions of models\n", report.copy.string(),
             report.bytes, report.samples, newest ? " up to " + *newest : "", report.versions);
  if (report.shards > 0)
    fmt::print("{}.shards: {} shards, {} bytes of them new\n", report.copy.string(), report.shards,
               report.shard_bytes);
}

int run(Arguments& arguments) {
  // With a configuration one word is enough: the copy.
  if (arguments.copy.empty() && arguments.database.database && arguments.database.config)
    arguments.copy = *std::exchange(arguments.database.database, std::nullopt);
  if (arguments.copy.empty())
    return refuse({"copy is required: the file to make; see reident backup --help"});
  const auto path = database_path(arguments.database);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  arguments.file = std::get<std::filesystem::path>(path).string();
  const StopSignal stop;
  return refusing_what_cannot_be([&] {
    storage::Database source(arguments.file, storage::Database::Mode::read_only);
    Progress bar;
    const auto report =
        back_up(source, arguments.copy, arguments.options, [&](const auto& progress) {
          bar.update(static_cast<double>(progress.done) / static_cast<double>(progress.pages),
                     fmt::format("{} of {} pages", progress.done, progress.pages));
          return !stop.token().stop_requested();
        });
    bar.clear();
    if (!report) {
      print_error("reident: stopped; nothing of the copy was kept");
      return exit_failed;
    }
    print(*report, arguments.json);
    return exit_done;
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_file_argument(command, arguments->database, "database of the service");
  command.add_option("copy", arguments->copy, "file to make");
  command.add_flag("--replace", arguments->options.replace,
                   "put the copy in the place of a file that exists");
  command.add_flag("--json", arguments->json, "one JSON object with what was copied");
  command.footer(
      "The copy holds one moment, and takes its name when it is whole and on the disk.\n"
      "Example:\n  reident backup reident.db /backup/reident-2026-03-01.db");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"backup", "Copy the database while the service writes it",
                                   WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::backup_verb
