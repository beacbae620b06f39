// reident: the command line.
#include <cerrno>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "service/cli/verb.hpp"

namespace reident::cli {
namespace {

int run(int argc, char** argv) {
  CLI::App app("Keeps the equipment models of satellite simulators true to the satellite",
               "reident");
  app.require_subcommand(1);
  app.fallthrough();  // --remote may stand behind a command that cannot have it: the refusal says
                      // why
  const CLI::Option* remote =
      app.add_flag("--remote")
          ->description(
              "with a command that reads: ask the running service over DDS instead of a file");
  const auto remote_in_vain = [&app, remote]() -> std::optional<std::string> {
    for (const Verb& verb : verbs())
      if (verb.works_on != WorksOn::history && remote->count() > 0 &&
          app.got_subcommand(std::string(verb.name)))
        return why_not_remote(verb);
    return std::nullopt;
  };
  app.parse_complete_callback([&remote_in_vain] {
    if (const auto why = remote_in_vain()) throw CLI::ValidationError(*why);
  });
  app.footer("reident COMMAND --help shows the options of a command and an example.");
  int exit_code = exit_done;
  for (const Verb& verb : verbs()) {
    CLI::App* command = app.add_subcommand(std::string(verb.name), std::string(verb.purpose));
    command->group(std::string(group_title(verb.works_on)));
    command->callback([work = verb.declare(*command), &exit_code] { exit_code = work(); });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    if (const auto why = remote_in_vain()) return refuse({*why});
    std::string command = "reident";
    for (const CLI::App* chosen : app.get_subcommands()) command += " " + chosen->get_name();
    return refuse({fmt::format("{}; see {} --help", error.what(), command)});
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    fmt::print(stderr, "reident: the output cannot be written: {}\n",
               std::generic_category().message(errno));
    return exit_failed;
  }
  return exit_code;
}

}  // namespace
}  // namespace reident::cli

int main(int argc, char** argv) {
  try {
    return reident::cli::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "reident: {}\n", error.what());
    return reident::cli::exit_failed;
  }
}
