// reident: the command line.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/cli/verb.hpp"
#include "service/dds/middleware_log.hpp"
#include "service/support/allocator.hpp"
#include "service/support/terminal.hpp"
#include "service/support/text.hpp"
#include "service/support/version.hpp"

namespace reident::cli {
namespace {

constexpr std::string_view default_verb = "overview";  // in a folder with a configuration

/// What is printed is read by a program: its lines are left as they are.
bool is_for_programs(const std::vector<std::string>& words) {
  const auto is_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (std::any_of(words.begin(), words.end(), is_help)) return false;
  return std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word == "--json" || word == "--csv" || word == "export" || word == "--markdown" ||
           word == "--man" || word == "--completion";
  });
}

/// What is printed may be longer than a screen.
bool is_long(const std::vector<std::string>& words) {
  constexpr std::array verbs_with_much = {"history", "show", "why", "compare", "completeness"};
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(verbs_with_much.begin(), verbs_with_much.end(), word) != verbs_with_much.end();
  });
}

/// Why the first word that is no option names no verb; absent where it does, or there is none.
std::optional<Refusal> unknown_verb(const std::vector<std::string>& words) {
  auto word = words.begin();
  while (word != words.end() && word->starts_with('-'))
    word += *word == "--security" && word + 1 != words.end() ? 2 : 1;  // its folder follows
  if (word == words.end()) return std::nullopt;
  std::vector<std::string> names;
  for (const Verb& verb : verbs()) names.emplace_back(verb.name);
  if (std::find(names.begin(), names.end(), *word) != names.end()) return std::nullopt;
  return Refusal{fmt::format("there is no command {}{}; reident help lists them", *word,
                             did_you_mean(*word, names))};
}

/// The words behind "reident", with what they stand for: `help VERB` is `VERB --help`.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  std::error_code error;
  if (words.empty() && std::filesystem::exists(default_config_file, error))
    words.emplace_back(default_verb);
  if (words.size() == 2 && words[0] == "help" && !words[1].starts_with('-'))
    words = {words[1], "--help"};
  return words;
}

int run(int argc, char** argv) {
  dds::log_what_the_middleware_says();
  std::vector<std::string> words = words_of(argc, argv);
  std::optional<FoldedOutput> folded;
  if (!is_for_programs(words)) folded.emplace(is_long(words));
  CLI::App app("Keeps the equipment models of satellite simulators true to the satellite",
               "reident");
  app.require_subcommand(1);
  app.fallthrough();  // --remote may stand behind a command that cannot have it: the refusal says
                      // why
  app.add_flag_callback(
      "--version", [] { throw CLI::CallForVersion(std::string(program_version()), exit_done); },
      "print the version of the program");
  const CLI::Option* remote =
      app.add_flag("--remote")
          ->description(
              "with a command that reads: ask the running service over DDS instead of a file");
  app.add_option_function<std::string>(
         "--security",
         [](const std::string& folder) { ::setenv("REIDENT_SECURITY", folder.c_str(), 1); },
         "on a secured domain: folder of your own certificate (REIDENT_SECURITY, or what the "
         "configuration names)")
      ->type_name("FOLDER");
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
  app.footer(
      "reident COMMAND --help shows the options of a command and an example.\nIn a folder "
      "with a reident.toml, reident alone is reident overview.");
  int exit_code = exit_done;
  for (const Verb& verb : verbs()) {
    CLI::App* command = app.add_subcommand(std::string(verb.name), std::string(verb.purpose));
    command->group(std::string(group_title(verb.works_on)));
    command->callback([work = verb.declare(*command), &exit_code] { exit_code = work(); });
  }
  if (const auto refusal = unknown_verb(words)) return refuse(*refusal);
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
  } catch (const CLI::ParseError& error) {
    if (const auto why = remote_in_vain()) return refuse({*why});
    std::string command = "reident";
    for (const CLI::App* chosen : app.get_subcommands()) command += " " + chosen->get_name();
    return refuse({fmt::format("{}; see {} --help", error.what(), command)});
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    print_error("reident: the output cannot be written: {}",
                std::generic_category().message(errno));
    return exit_failed;
  }
  return exit_code;
}

}  // namespace
}  // namespace reident::cli

int main(int argc, char** argv) {
  reident::keep_freed_memory();
  try {
    return reident::cli::run(argc, argv);
  } catch (const std::exception& error) {
    reident::print_error("reident: {}", error.what());
    return reident::cli::exit_failed;
  }
}
