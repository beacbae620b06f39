#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/file_errors.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/support/progress.hpp"
#include "service/support/size_text.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/utc_clock.hpp"
#include "storage/archive/holdings.hpp"
#include "storage/care/split.hpp"

namespace reident::cli::archive_verb {
namespace {

struct Arguments {
  DatabaseOptions database;
  std::string file;
  std::optional<std::int64_t> before;
  bool json = false;
};

/// The year of the newest telemetry, or of the clock where that is earlier.
std::int64_t year_of_newest(const storage::Database& database) {
  storage::Time newest = 0;
  for (const storage::SeriesInfo& series : storage::all_series(database))
    newest = std::max(newest, series.last);
  return storage::year_of(std::min(newest, utc_now()));
}

void print(const Arguments& arguments, const std::filesystem::path& database, std::int64_t before,
           const storage::SplitReport& report) {
  if (arguments.json) {
    nlohmann::ordered_json shards = nlohmann::ordered_json::array();
    for (const auto& shard : report.made)
      shards.push_back({{"file", shard.file},
                        {"chunks", shard.chunks},
                        {"samples", shard.samples},
                        {"bytes", shard.bytes}});
    fmt::print("{}\n", nlohmann::ordered_json({{"before", before},
                                               {"complete", report.complete},
                                               {"chunks", report.chunks},
                                               {"shards", shards}})
                           .dump());
    return;
  }
  for (const auto& shard : report.made)
    fmt::print("{}.shards/{}: {} samples, {}\n", database.string(), shard.file, shard.samples,
               size_text(shard.bytes));
  if (report.chunks == 0)
    fmt::print(
        "nothing to split: what is of before {} is in shards already, but for what the database "
        "has in one piece with {}\n",
        before, before);
}

int split(const Arguments& arguments) {
  const StopSignal stop;
  storage::Database database(arguments.file, storage::Database::Mode::update);
  const std::int64_t before = arguments.before.value_or(year_of_newest(database));
  storage::Archive archive(database);
  archive.compact();
  Progress bar;
  const storage::SplitReport report =
      split_by_year(archive, before, [&](const storage::SplitProgress& progress) {
        bar.update(static_cast<double>(progress.done) /
                       static_cast<double>(std::max<std::uint64_t>(1, progress.chunks)),
                   fmt::format("{} of {} chunks", progress.done, progress.chunks));
        return !stop.token().stop_requested();
      });
  if (report.complete && report.chunks > 0) give_back_room(database);
  bar.clear();
  print(arguments, database.path(), before, report);
  if (!report.complete)
    print_error("reident: stopped; every sample is there, and the same command goes on");
  return report.complete ? exit_done : exit_failed;
}

int run(Arguments& arguments) {
  const auto path = database_path(arguments.database);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  arguments.file = std::get<std::filesystem::path>(path).string();
  return refusing_what_cannot_be([&] {
    try {
      return split(arguments);
    } catch (const storage::Error& error) {
      if (error.kind() != storage::Error::Kind::locked) throw;
      return refuse(
          {fmt::format("{}; stop the service for as long as the split takes: its sources "
                       "keep what it has not stored",
                       error.what())});
    }
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.require_subcommand(1);
  CLI::App* parts =
      command.add_subcommand("split", "Move the telemetry of closed years into files of their own");
  add_file_argument(*parts, arguments->database, "database, which no service may hold");
  parts->get_option("--config")->excludes("--database");
  parts
      ->add_option("--before", arguments->before,
                   "first year that stays in the database; else that of the newest telemetry")
      ->check(CLI::Range(1970, 2262));
  parts->add_flag("--json", arguments->json, "one JSON object with what was moved");
  parts->group("Commands");
  command.footer(
      "The files are in FILE.shards and never change. A piece of telemetry that crosses a new year "
      "goes with the later one. The archive is read as one with them: move "
      "and copy both together, or use 'reident backup'.\n"
      "Example:\n"
      "  reident archive split reident.db --before 2026");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"archive",
                                   "Keep the telemetry of closed years in files of their own",
                                   WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::archive_verb
