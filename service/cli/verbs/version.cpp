#include "service/support/version.hpp"

#include <fmt/format.h>

#include "service/cli/verb.hpp"

namespace reident::cli::version_verb {
namespace {

std::function<int()> declare(CLI::App& command) {
  command.footer("Example:\n  reident version");
  return []() -> int {
    fmt::print("reident {}\n", program_version());
    return exit_done;
  };
}

const VerbRegistration registered({"version", "Print the version of the program", WorksOn::files,
                                   declare});

}  // namespace

}  // namespace reident::cli::version_verb
