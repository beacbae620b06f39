#include <fmt/format.h>

#include "service/cli/shell_completion.hpp"
#include "service/cli/verb.hpp"
#include "service/support/version.hpp"

namespace reident::cli::help_verb {
namespace {

enum class Form { text, markdown, man };

/// The help of a verb without its first lines, for man: as it is, without folding.
std::string manual_of(const Verb& verb) {
  CLI::App app("", "reident");
  app.add_flag("--remote");  // which verbs of the history look for
  CLI::App* command = app.add_subcommand(std::string(verb.name));
  verb.declare(*command);
  std::string text;
  for (const char c : command->help("reident")) {
    if ((c == '.' || c == '\'') && (text.empty() || text.back() == '\n')) text += "\\&";
    if (c == '-' || c == '\\') text += '\\';
    text += c;
  }
  return text;
}

void print_text() {
  for (const Verb& verb : verbs()) fmt::print("{:<16}{}\n", verb.name, verb.purpose);
}

/// The rows of README.md between its marks.
void print_markdown() {
  fmt::print("| verb | purpose |\n|---|---|\n");
  for (const Verb& verb : verbs()) fmt::print("| `{}` | {} |\n", verb.name, verb.purpose);
}

/// A page for man(7).
void print_man() {
  fmt::print(
      ".TH REIDENT 1 \"\" \"reident {}\" \"User commands\"\n"
      ".SH NAME\nreident \\- keeps the equipment models of satellite simulators true to the "
      "satellite\n"
      ".SH SYNOPSIS\n.B reident\n.I VERB\n[\\fIOPTION\\fR]...\n"
      ".SH DESCRIPTION\nShows, compares, exports and decides about versions of equipment models, "
      "and works on their database. \\fBreident \\fIVERB\\fB \\-\\-help\\fR has the options of a "
      "verb and an example.\n",
      program_version());
  const Verb* before = nullptr;
  for (const Verb& verb : verbs()) {
    if (before == nullptr || before->works_on != verb.works_on)
      fmt::print(".SH {}\n", group_title(verb.works_on));
    fmt::print(".TP\n.B {}\n{}.\n", verb.name, verb.purpose);
    before = &verb;
  }
  fmt::print(".SH OPTIONS OF THE VERBS\n");
  for (const Verb& verb : verbs()) fmt::print(".SS {}\n.nf\n{}.fi\n", verb.name, manual_of(verb));
  fmt::print(
      ".SH EXIT STATUS\n0 done; 1 the machine would not (a file that cannot be written, a full "
      "disk), or verify found damage; or somebody has to act; 2 the request cannot be met, with "
      "one line that says what "
      "would mend it; 3 the data give no model; 4 nothing answered in time.\n"
      ".SH SEE ALSO\nreidentd \\-\\-help, satcs-replay \\-\\-help, satcs-reference \\-\\-help\n");
}

std::function<int()> declare(CLI::App& command) {
  const auto form = std::make_shared<Form>(Form::text);
  command.add_flag_callback(
      "--markdown", [form] { *form = Form::markdown; }, "as the table of README.md");
  command.add_flag_callback(
      "--man", [form] { *form = Form::man; }, "as a page for man");
  const auto shell = std::make_shared<std::string>();
  command.add_option("--completion", *shell, "a script for bash, zsh or fish");
  command.footer(
      "Example:\n  reident help --man > reident.1\n  reident help --completion bash > "
      "reident.bash");
  return [form, shell] {
    if (!shell->empty()) {
      const auto script = completion_script(*shell);
      if (!script)
        return refuse({fmt::format("there is no completion for {}; there is for bash, zsh and fish",
                                   *shell)});
      fmt::print("{}", *script);
      return static_cast<int>(exit_done);
    }
    switch (*form) {
      case Form::text:
        print_text();
        break;
      case Form::markdown:
        print_markdown();
        break;
      case Form::man:
        print_man();
        break;
    }
    return static_cast<int>(exit_done);
  };
}

const VerbRegistration registered({"help", "List the verbs", WorksOn::files, declare});

}  // namespace
}  // namespace reident::cli::help_verb
