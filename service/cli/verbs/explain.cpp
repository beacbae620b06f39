#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/output/table.hpp"
#include "service/cli/verb.hpp"
#include "service/model/glossary.hpp"
#include "service/support/text.hpp"

namespace reident::cli::explain_verb {
namespace {

struct Arguments {
  std::string code;
  bool json = false;
};

nlohmann::ordered_json json_of(const GlossaryEntry& entry) {
  return {{"code", entry.code},
          {"words", entry.words},
          {"meaning", entry.meaning},
          {"remedy", entry.remedy.empty() ? nlohmann::ordered_json() : entry.remedy}};
}

int list(bool json) {
  if (json) {
    auto all = nlohmann::ordered_json::array();
    for (const GlossaryEntry& entry : glossary()) all.push_back(json_of(entry));
    fmt::print("{}\n", nlohmann::ordered_json{{"codes", std::move(all)}}.dump(2));
    return exit_done;
  }
  Table table({{"code"}, {"in words"}});
  for (const GlossaryEntry& entry : glossary())
    table.add({std::string(entry.code), std::string(entry.words)});
  fmt::print("{}", table.text(terminal_width()));
  return exit_done;
}

int run(const Arguments& arguments) {
  if (arguments.code.empty()) return list(arguments.json);
  const GlossaryEntry* entry = explanation_of(arguments.code);
  if (!entry) {
    std::vector<std::string> codes;
    for (const GlossaryEntry& one : glossary()) codes.emplace_back(one.code);
    return refuse({fmt::format("there is no code {}{}; reident explain lists them", arguments.code,
                               did_you_mean(arguments.code, codes))});
  }
  if (arguments.json) {
    fmt::print("{}\n", json_of(*entry).dump(2));
    return exit_done;
  }
  fmt::print("{}: {}\n{}\n", entry->code, entry->words, entry->meaning);
  fmt::print("What to do: {}\n", entry->remedy.empty() ? "nothing." : entry->remedy);
  return exit_done;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("code", arguments->code, "of an outcome, a reason or an alarm (all of them)");
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer("Example:\n  reident explain bias_unverified");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"explain", "Say what a code of an outcome, a reason or an alarm means, and what to do",
     WorksOn::files, declare});

}  // namespace
}  // namespace reident::cli::explain_verb
