#include "service/support/version.hpp"

#include <fmt/format.h>

#include "service/cli/command.hpp"

namespace reident::cli {

void add_version(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("version", "Print the version of the program");
  command->footer("Example:\n  reident version");
  command->callback([&exit_code] {
    fmt::print("reident {}\n", program_version());
    exit_code = exit_done;
  });
}

}  // namespace reident::cli
