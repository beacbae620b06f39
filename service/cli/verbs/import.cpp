#include "service/transfer/import.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/output/throughput.hpp"
#include "service/cli/phase_advice.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/support/progress.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/utc_clock.hpp"
#include "service/telemetry_file/reading_options.hpp"
#include "service/transfer/undo.hpp"

namespace reident::cli::import_verb {
namespace {

using transfer::ImportOptions;
using transfer::ImportProgress;
using transfer::ImportReport;

struct Arguments {
  DatabaseOptions database;
  ImportOptions import;
  std::vector<std::string> mappings;
  std::optional<std::string> origin;
  telemetry_file::ReadingArguments reading;
  bool json = false;
  bool undo = false;
};

std::optional<Refusal> complete(Arguments& arguments) {
  for (const std::string& text : arguments.mappings) {
    const auto mapping = satcs::parse_mapping(text);
    if (!mapping) return Refusal{fmt::format("--map {} is not COLUMN=PARAMETER[:UNIT]", text)};
    arguments.import.mappings.push_back(*mapping);
  }
  if (arguments.origin) arguments.import.origin = transfer::parse_origin(*arguments.origin);
  auto reading = telemetry_file::reading_options(arguments.reading, utc_now());
  if (const auto* error = std::get_if<csv::Error>(&reading)) return Refusal{error->message};
  arguments.import.reading = std::get<telemetry_file::ReadingOptions>(std::move(reading));
  arguments.import.reading.spacecraft = arguments.import.spacecraft;
  arguments.import.skip_bad_lines = arguments.reading.skip_bad_lines;
  return std::nullopt;
}

std::string outcome(const ImportReport& report) {
  const auto& total = report.total;
  if (!report.complete) return "stopped; the same command goes on where it ended";
  if (!report.postponed.empty()) return "done; late samples wait: " + report.postponed;
  if (total.stored == 0 && total.conflicts == 0)
    return total.samples == 0 ? "there was no sample in it"
                              : "all of it was in the archive already";
  return "done";
}

void print_json(const ImportReport& report, double seconds) {
  const auto& total = report.total;
  const nlohmann::ordered_json object = {{"found", report.found},
                                         {"remarks", report.remarks},
                                         {"left_out", report.left_out.sentences()},
                                         {"postponed", text_json(report.postponed)},
                                         {"complete", report.complete},
                                         {"resumed_at_line", report.resumed_at},
                                         {"rows", total.rows},
                                         {"samples", total.samples},
                                         {"stored", total.stored},
                                         {"duplicates", total.duplicates},
                                         {"conflicts", total.conflicts},
                                         {"bad_lines", total.bad_lines},
                                         {"new_parameters", report.new_parameters},
                                         {"samples_this_run", report.samples},
                                         {"seconds", seconds}};
  fmt::print("{}\n", object.dump());
}

void print_text(const ImportReport& report, double seconds) {
  const auto& total = report.total;
  if (report.resumed_at != 0)
    fmt::print("went on at line {}, where the last run ended\n", report.resumed_at);
  fmt::print("{} samples in {} rows: {} stored, {} there already, {} in conflict with others\n",
             total.samples, total.rows, total.stored, total.duplicates, total.conflicts);
  if (report.new_parameters > 0) fmt::print("{} new parameters\n", report.new_parameters);
  if (total.bad_lines > 0) fmt::print("{} bad lines left out\n", total.bad_lines);
  for (const std::string& sentence : report.left_out.sentences()) fmt::print("  {}\n", sentence);
  fmt::print("{} ({} samples in {:.1f} s, {}/s)\n", outcome(report), report.samples, seconds,
             short_count(static_cast<double>(report.samples) / seconds));
}

int show(const ImportOptions& options) {
  const auto shown =
      telemetry_file::dry_run(telemetry_file::TelemetryFile::open(options.file, options.reading),
                              options.file, true, options.spacecraft.has_value());
  if (const auto* error = std::get_if<csv::Error>(&shown)) return refuse({error->message});
  for (const std::string& line : std::get<std::vector<std::string>>(shown))
    fmt::print("{}\n", line);
  return exit_done;
}

int undo(const Arguments& arguments) {
  const auto take_back = [&](storage::Database& database) {
    const auto undone = transfer::undo_import(database, arguments.import.file);
    if (const auto* error = std::get_if<csv::Error>(&undone)) return refuse({error->message});
    const auto& report = std::get<storage::SourceRemovalReport>(undone);
    if (arguments.json)
      fmt::print("{}\n", nlohmann::ordered_json(
                             {{"removed", report.samples}, {"parameters", report.series}})
                             .dump());
    else
      fmt::print("{} samples of {} parameters removed; the file can be imported again\n",
                 report.samples, report.series);
    return static_cast<int>(exit_done);
  };
  return with_writable_database(arguments.database, take_back, storage::Database::Mode::update);
}

/// Where the configuration names the database.
std::vector<std::string> advice(storage::Database& database, const DatabaseOptions& options) {
  if (options.database) return {};
  const auto chosen = chosen_config(options.config);
  const auto* config = std::get_if<std::optional<Config>>(&chosen);
  return config && *config ? advised_phases(database, **config) : std::vector<std::string>{};
}

int run(Arguments& arguments) {
  if (arguments.undo) return undo(arguments);
  if (const auto refusal = complete(arguments)) return refuse(*refusal);
  if (arguments.reading.dry_run) return show(arguments.import);
  // Before a database is made for nothing.
  auto opened =
      telemetry_file::TelemetryFile::open(arguments.import.file, arguments.import.reading);
  if (const auto* error = std::get_if<csv::Error>(&opened)) return refuse({error->message});
  auto& file = std::get<telemetry_file::TelemetryFile>(opened);
  const StopSignal stop;
  return with_writable_database(arguments.database, [&](storage::Database& database) {
    Progress bar;
    Throughput pace;
    const auto imported = transfer::import_file(
        database, file, arguments.import, utc_now, [&](const ImportProgress& at) {
          if (bar.due()) bar.update(at.fraction, pace.text(at.fraction, at.samples));
          return !stop.token().stop_requested();
        });
    bar.clear();
    if (const auto* error = std::get_if<csv::Error>(&imported)) return refuse({error->message});
    const auto& report = std::get<ImportReport>(imported);
    if (!arguments.json) print_error("{}: {}", arguments.import.file.string(), report.found);
    for (const std::string& remark : report.remarks) print_error("reident: {}", remark);
    for (const std::string& sentence : advice(database, arguments.database))
      print_error("reident: {}", sentence);
    for (const std::string& message : report.first_bad_lines)
      print_error("reident: left out: {}", message);
    if (arguments.json)
      print_json(report, pace.seconds());
    else
      print_text(report, pace.seconds());
    return static_cast<int>(report.complete ? exit_done : exit_failed);
  });
}

void add_column_options(CLI::App& command, Arguments& arguments) {
  command
      .add_option("--map", arguments.mappings, "import a column as a parameter; may be given again")
      ->type_name("COLUMN=PARAMETER[:UNIT]")
      ->allow_extra_args(false);
  command.add_option("--only", arguments.import.only, "columns to import, separated by commas")
      ->delimiter(',')
      ->type_name("COLUMNS");
  command
      .add_option("--leave-out", arguments.import.leave_out,
                  "columns not to import, separated by commas")
      ->delimiter(',')
      ->type_name("COLUMNS");
  command.add_flag("--keep-names", arguments.import.keep_names,
                   "do not take units from names (bus_u_mv is bus_u in mV)");
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("file", arguments->import.file, "CSV file with a header row")->required();
  add_database_options(command, arguments->database);
  command.add_option("--spacecraft", arguments->import.spacecraft,
                     "spacecraft that the samples are of");
  command.add_option("--source", arguments->import.source,
                     "what they came from (the file's column source, or import:FILE)");
  command.add_option("--origin", arguments->origin, "real or simulated (real)")
      ->check(CLI::IsMember({"real", "simulated"}));
  add_column_options(command, *arguments);
  command.add_flag("--undo", arguments->undo,
                   "take the samples that imports of this file brought out of the database again");
  add_reading_options(command, arguments->reading);
  command.add_flag("--json", arguments->json, "one JSON object with the counts");
  command.footer(
      "A file has a column with the time and one for each parameter, or one sample a row in the "
      "columns parameter, time and value, and spacecraft, origin, source, quality and unit where "
      "there are any. An empty cell is no sample.\n"
      "Stopped or killed, the same command goes on where it ended. A second import stores nothing "
      "twice. Works on the file, so reidentd must not run.\n"
      "Example:\n"
      "  reident import telemetry.csv --db reident.db --spacecraft SAT-1\n"
      "Exit status: 2 for a file that cannot be imported, 1 when stopped or the disk is full.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"import", "Bring telemetry from a CSV file in",
                                   WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::import_verb
