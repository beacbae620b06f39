#include "service/cli/shell_completion.hpp"

#include <vector>

#include <fmt/format.h>

#include "service/cli/verb.hpp"

namespace reident::cli {
namespace {

struct Word {
  std::string name;     // "--config"
  std::string meaning;  // one line
};

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// The long options of a verb.
std::vector<Word> options_of(const Verb& verb) {
  CLI::App app;
  app.add_flag("--remote");  // which verbs of the history look for
  CLI::App* command = app.add_subcommand(std::string(verb.name));
  verb.declare(*command);
  std::vector<Word> options;
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : option->get_lnames())
      options.push_back({"--" + name, first_line(option->get_description())});
  return options;
}

std::string names_of(const std::vector<Word>& words) {
  std::string names;
  for (const Word& word : words) names += (names.empty() ? "" : " ") + word.name;
  return names;
}

std::vector<Word> all_verbs() {
  std::vector<Word> words;
  for (const Verb& verb : verbs())
    words.push_back({std::string(verb.name), std::string(verb.purpose)});
  return words;
}

/// The lines of a case statement that bash and zsh share: the options of each verb.
std::string cases(std::string_view action) {
  std::string text;
  for (const Verb& verb : verbs())
    text += fmt::format("    {}) {} ;;\n", verb.name,
                        fmt::format(fmt::runtime(action), names_of(options_of(verb))));
  return text;
}

std::string bash_script() {
  return fmt::format(
      "_reident() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} verb= options=\n"
      "  local i\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    [[ ${{COMP_WORDS[i]}} == -* ]] || {{ verb=${{COMP_WORDS[i]}}; break; }}\n"
      "  done\n"
      "  if [[ -z $verb || $verb == help ]]; then\n"
      "    COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case $verb in\n{}  esac\n"
      "  if [[ $word == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
      "  else\n"
      "    COMPREPLY=($(compgen -f -- \"$word\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _reident reident\n",
      names_of(all_verbs()), cases("options=\"{}\""));
}

std::string zsh_script() {
  return fmt::format(
      "#compdef reident\n"
      "_reident() {{\n"
      "  if (( CURRENT == 2 )); then\n"
      "    compadd - {}\n"
      "    return\n"
      "  fi\n"
      "  case $words[2] in\n{}  esac\n"
      "  _files\n"
      "}}\n"
      "_reident \"$@\"\n",
      names_of(all_verbs()), cases("compadd - {}"));
}

std::string fish_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text)
    quoted += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string{c};
  return quoted + "'";
}

std::string fish_script() {
  std::string text;
  for (const Word& verb : all_verbs())
    text += fmt::format("complete -c reident -n __fish_use_subcommand -f -a {} -d {}\n", verb.name,
                        fish_quoted(verb.meaning));
  for (const Verb& verb : verbs())
    for (const Word& option : options_of(verb))
      text += fmt::format("complete -c reident -n '__fish_seen_subcommand_from {}' -l {} -d {}\n",
                          verb.name, option.name.substr(2), fish_quoted(option.meaning));
  return text;
}

}  // namespace

std::optional<std::string> completion_script(std::string_view shell) {
  if (shell == "bash") return bash_script();
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_script();
  return std::nullopt;
}

}  // namespace reident::cli
