// What every main() does with its command line.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "service/support/terminal.hpp"
#include "service/support/version.hpp"

namespace reident {

/// Parses the command line, to which --version is added. Returns the exit status where nothing is
/// left to do: 0 after help or version were printed, 2 after a line on standard error said what is
/// wrong.
inline std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
  constexpr int exit_done = 0, exit_bad_request = 2;
  app.set_version_flag("--version", std::string(program_version()));
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const FoldedOutput folded(false);
    fmt::print("{}", app.help());
    return exit_done;
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
    return exit_done;
  } catch (const CLI::ParseError& error) {
    print_error("{}: {}; see {} --help", app.get_name(), error.what(), app.get_name());
    return exit_bad_request;
  }
  return std::nullopt;
}

}  // namespace reident
