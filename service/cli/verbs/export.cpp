#include "service/transfer/export.hpp"

#include <csignal>
#include <limits>
#include <unistd.h>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/throughput.hpp"
#include "service/cli/replace_option.hpp"
#include "service/cli/time_options.hpp"
#include "service/cli/verb.hpp"
#include "service/support/output_file.hpp"
#include "service/support/progress.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/transfer/telemetry_csv.hpp"

namespace reident::cli::export_verb {
namespace {

using transfer::ExportOptions;
using transfer::ExportProgress;
using transfer::ExportReport;

constexpr const char* standard_output = "-";

struct Arguments {
  HistoryAccessOptions access;
  ExportOptions options;
  std::optional<std::string> origin;
  TimeOptions time;
  std::string output = standard_output;
  bool replace = false;
};

int write(const history::TelemetryReader& telemetry, const std::vector<storage::SeriesInfo>& series,
          const Arguments& arguments) {
  const StopSignal stop;
  const bool to_file = arguments.output != standard_output;
  OutputFile file =
      to_file ? OutputFile(arguments.output, arguments.replace ? OutputFile::Existing::replaced
                                                               : OutputFile::Existing::kept)
              : OutputFile::standard_output();
  Progress bar(stderr, to_file && isatty(STDERR_FILENO) == 1);
  Throughput pace;
  const ExportReport report = transfer::export_series(
      telemetry, series, arguments.options, [&](std::string_view text) { file.write(text); },
      [&](const ExportProgress& at) {
        if (bar.due()) bar.update(at.fraction, pace.text(at.fraction, at.samples));
        return !stop.token().stop_requested();
      });
  bar.clear();
  if (!report.complete) {
    print_error("reident: stopped; {}",
                to_file ? "no file was written" : "the output ends in the middle");
    return exit_failed;
  }
  file.finish();
  if (to_file)
    fmt::print("{}: {} samples of {} series in {} rows\n", arguments.output, report.samples,
               report.series, report.rows);
  return exit_done;
}

int run(Arguments& arguments) {
  using Limits = std::numeric_limits<storage::Time>;
  std::signal(SIGPIPE, SIG_IGN);
  const auto range = chosen_range(arguments.time, {Limits::min(), Limits::max()});
  if (const auto* refusal = std::get_if<Refusal>(&range)) return refuse(*refusal);
  arguments.options.range = std::get<storage::TimeRange>(range);
  if (arguments.origin) arguments.options.origin = transfer::parse_origin(*arguments.origin);
  if (const auto refusal = exists_already(arguments.output, arguments.replace))
    return refuse(*refusal);
  return with_readers(arguments.access, [&](const Readers& readers) {
    const auto series = transfer::series_to_export(readers.telemetry, arguments.options);
    if (const auto* error = std::get_if<csv::Error>(&series)) return refuse({error->message});
    return write(readers.telemetry, std::get<std::vector<storage::SeriesInfo>>(series), arguments);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_archive_options(command, arguments->access);
  command.add_option("--spacecraft", arguments->options.spacecraft, "this one alone (all)");
  command.add_option("--parameter", arguments->options.parameters, "these alone (all)");
  command.add_option("--origin", arguments->origin, "real or simulated alone (both)")
      ->check(CLI::IsMember({"real", "simulated"}));
  add_time_options(command, arguments->time, "samples");
  command.add_flag("--wide", arguments->options.wide,
                   "a row for each time and a column for each parameter, without quality and "
                   "source");
  command.add_option("-o,--output", arguments->output, "file; - is standard output")
      ->capture_default_str();
  add_replace_option(command, arguments->replace);
  command.footer(
      "One sample a row: spacecraft,parameter,origin,source,time,value,quality,unit, each series "
      "in order of time. Values have all their digits: reident import brings the same samples "
      "back.\n"
      "A file gets its name when it is complete. Works while reidentd writes.\n"
      "Example:\n"
      "  reident export reident.db --spacecraft SAT-1 --parameter V_BUS --from 2026-03-01 -o "
      "v.csv");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"export", "Write archived telemetry as CSV", WorksOn::history,
                                   declare});

}  // namespace

}  // namespace reident::cli::export_verb
