// satcs-replay: publishes recorded telemetry as a control centre would.

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/satcs/program.hpp"
#include "service/satcs/programs.hpp"
#include "service/satcs/replay/replay.hpp"
#include "service/support/log.hpp"
#include "service/support/terminal.hpp"
#include "service/support/utc_clock.hpp"
#include "service/telemetry_file/long_layout.hpp"
#include "service/telemetry_file/reading_options.hpp"

namespace reident::satcs {
namespace {

using telemetry_file::ReadingArguments;
using telemetry_file::ReadingOptions;

constexpr const char* about_replay =
    "Publishes the rows of a CSV file as SATCS telemetry frames, one frame a row.\n\n"
    "Examples:\n"
    "  satcs-replay telemetry.csv --spacecraft SAT-1 --speed max\n"
    "  satcs-replay telemetry.csv --spacecraft SAT-1 --time unix_s --speed 60 --start 2h \\\n"
    "      --map bus_u_mv=V_BUS:mV --only bus_u_mv,bus_i_ma --wait-timeout 30s\n\n"
    "Exit status: 0 every reader has every frame; 1 failure; 2 bad request; 3 readers were "
    "missing\n"
    "or did not take everything; 128 + N stopped by signal N.\n";

void add_replay_options(CLI::App& app, ReplayOptions& options) {
  app.add_option("file", options.file, "CSV file with a header row and a time column")
      ->required()
      ->type_name("FILE");
  app.add_option_function<std::vector<std::string>>(
         "--map",
         [&options](const std::vector<std::string>& texts) {
           for (const auto& text : texts) {
             auto mapping = parse_mapping(text);
             if (!mapping) {
               throw CLI::ValidationError("--map", "'" + text + "' is not COLUMN=PARAMETER[:UNIT]");
             }
             options.mappings.push_back(*std::move(mapping));
           }
         },
         "Publish a column as a parameter; may be given again")
      ->type_name("COLUMN=PARAMETER[:UNIT]")
      ->allow_extra_args(false);
  app.add_flag("--keep-names", options.keep_names,
               "Do not take units from names (bus_u_mv is bus_u in mV)");
  app.add_flag("--invalid-blanks,!--skip-blanks", options.invalid_blanks,
               "A blank cell is an invalid sample, which ends the hold of the one before it.\n"
               "By default (--skip-blanks) it is none, as in reident import");
  app.add_option("--only", options.only, "Columns to publish, separated by commas")
      ->delimiter(',')
      ->type_name("COLUMNS");
  const std::string bound = "a time, or an offset such as +90 or 2h";
  add_parsed(app, "--start", options.start, parse_bound,
             "Leave out rows before this time, or this long after the earliest row", bound)
      ->type_name("TIME|OFFSET");
  add_parsed(app, "--end", options.end, parse_bound, "Leave out rows from this time on", bound)
      ->type_name("TIME|OFFSET");
}

void say(const ReplayPlan& plan) {
  reident::print_error("{}: {}", plan.file.string(), plan.found);
  for (const auto& remark : plan.remarks) reident::print_error("satcs-replay: {}", remark);
  for (const auto& column : plan.left_out)
    reident::log::info("satcs", "column left out, there is no number in it", {{"column", column}});
}

void read_arguments(const ReadingArguments& arguments, ReplayOptions& options) {
  auto reading = reading_options(arguments, reident::utc_now());
  if (const auto* error = std::get_if<reident::csv::Error>(&reading))
    throw BadRequest(error->message);
  options.reading = std::get<ReadingOptions>(std::move(reading));
  options.skip_bad_lines = arguments.skip_bad_lines;
}

ReplayPlan make_plan(const ReplayOptions& options) {
  auto planned = plan_replay(options);
  if (const auto* error = std::get_if<reident::csv::Error>(&planned)) {
    throw BadRequest(error->message);
  }
  say(std::get<ReplayPlan>(planned));
  return std::get<ReplayPlan>(std::move(planned));
}

/// How the file was read, for programs.
std::string json_of(const ReplayPlan& plan) {
  const nlohmann::ordered_json json = {
      {"found", plan.found}, {"remarks", plan.remarks}, {"columns_left_out", plan.left_out}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int show(const ReplayOptions& options) {
  const auto shown = reident::telemetry_file::dry_run(
      reident::telemetry_file::open_as_table(options.file, options.reading, options.skip_bad_lines),
      options.file, true);
  if (const auto* error = std::get_if<reident::csv::Error>(&shown))
    throw BadRequest(error->message);
  const reident::FoldedOutput folded(false);
  for (const auto& line : std::get<std::vector<std::string>>(shown)) fmt::print("{}\n", line);
  return exit_complete;
}

}  // namespace

int replay_main(int argc, char** argv) {
  CLI::App app(about_replay, "satcs-replay");
  ReplayOptions replay;
  Sender sender{.source = "replay"};
  PublisherOptions publisher;
  bool json = false;
  ReadingArguments reading;
  add_replay_options(app, replay);
  add_reading_options(app, reading);
  add_publisher_options(app, sender, publisher, json);
  app.get_option("--spacecraft")->required();
  return run_program(app, argc, argv, [&] {
    read_arguments(reading, replay);
    replay.reading.spacecraft = publisher.spacecraft;
    if (reading.dry_run) return show(replay);
    ReplayPlan plan = make_plan(replay);
    const std::string found = json_of(plan);
    ReplayStream stream(std::move(plan), sender);
    const reident::StopSignal stop;
    return publish_and_report(stream, sender, publisher, json, stop, [&found] { return found; });
  });
}

}  // namespace reident::satcs
