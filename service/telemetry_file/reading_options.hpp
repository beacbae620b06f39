// The options of a file of telemetry on a command line: the same in every program that reads one.
#pragma once

#include <CLI/CLI.hpp>

#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file {

/// What a command line says, before it is checked.
struct ReadingArguments {
  std::optional<std::string> separator, decimal, thousands, encoding, header, units, line_end,
      comment;
  std::vector<std::string> names;
  std::optional<std::string> time, time_format, time_unit, time_zone, epoch, clock_back;
  bool force_times = false;
  std::vector<std::string> missing, map_states;
  bool skip_bad_lines = false;
  bool dry_run = false;
};

/// Adds --separator, --decimal, --thousands, --encoding, --header, --units, --line-end, --names,
/// --comment, --time and
/// what is said of it, --missing, --map-states, --skip-bad-lines and --dry-run. The arguments have
/// to live until the command line was parsed.
void add_reading_options(CLI::App& app, ReadingArguments& arguments);

/// Returns the options, or what is wrong with an argument. `now_ns` is the time [ns since 1970].
std::variant<ReadingOptions, Error> reading_options(const ReadingArguments& arguments,
                                                    std::int64_t now_ns);

/// Returns the first rows of a file as they are understood, one text a line, as --dry-run shows
/// them: the time and each column with its value. An error where the file or its time cannot be
/// read, and where rows with one sample each are to be `of_one_spacecraft` and are not.
std::variant<std::vector<std::string>, Error> dry_run(std::variant<TelemetryFile, Error> opened,
                                                      const std::filesystem::path& path,
                                                      bool needs_time,
                                                      bool of_one_spacecraft = true);

}  // namespace reident::telemetry_file
