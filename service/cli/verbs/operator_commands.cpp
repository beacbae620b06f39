#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/cli/operate.hpp"
#include "service/cli/output/stored_version.hpp"

namespace reident::cli {
namespace {

constexpr double max_timeout_s = 1e6;

struct Arguments {
  OperatorOptions options;
  std::string subject;
  std::int64_t version = 0;
};

int run(const Arguments& arguments, const std::string& action) {
  const auto parsed = parse_subject(arguments.subject);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return refuse(*refusal);
  const Subject& subject = std::get<Subject>(parsed);
  if (subject.version)
    return refuse(
        {fmt::format("{} names a version with the equipment; the version is a word or an "
                     "option of its own",
                     arguments.subject)});
  return operate(arguments.options,
                 {action, subject.spacecraft, subject.equipment, arguments.version});
}

/// A subcommand with what all of them have; the caller adds its own.
CLI::App* add(CLI::App& app, int& exit_code, const std::shared_ptr<Arguments>& arguments,
              const std::string& name, const std::string& action, const std::string& description) {
  CLI::App* command = app.add_subcommand(name, description);
  OperatorOptions& options = arguments->options;
  options.actor = login_name();
  command->add_option("equipment", arguments->subject, "EQUIPMENT or SPACECRAFT/EQUIPMENT")
      ->required();
  command->add_option("--actor", options.actor, "the operator's name, kept with the decision")
      ->capture_default_str();
  add_database_options(*command, options.database);
  command->add_option("--domain", options.domain, "DDS domain")->check(CLI::Range(0, 230));
  command->add_option("--partition", options.partition, "DDS partition");
  command->add_option("--timeout", options.timeout_s, "seconds to wait for the service")
      ->check(CLI::Range(0.0, max_timeout_s))
      ->capture_default_str();
  command->add_flag("--json", options.json, "one JSON object with the reply");
  command->callback([arguments, action, &exit_code] { exit_code = run(*arguments, action); });
  return command;
}

void footer(CLI::App& command, const std::string& example) {
  command.footer(fmt::format(
      "Example:\n  reident {} {}\n"
      "Exit status: 2 when it was refused, with the reason; 4 when no service answered in time.",
      command.get_name(), example));
}

void add_decision(CLI::App& app, int& exit_code, const std::string& name,
                  const std::string& description, const std::string& reason) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = add(app, exit_code, arguments, name, name, description);
  command->add_option("version", arguments->version, "number of the version")
      ->required()
      ->check(CLI::PositiveNumber);
  command->add_option("--reason", arguments->options.reason, "why, kept with the decision")
      ->required();
  footer(*command, fmt::format("CBERS-4/BDR 7 --reason \"{}\"", reason));
}

void add_order(CLI::App& app, int& exit_code, const std::string& name, const std::string& action,
               const std::string& description, const std::string& reason) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = add(app, exit_code, arguments, name, action, description);
  command->add_option("--reason", arguments->options.reason, "why, kept with it");
  footer(*command, fmt::format("CBERS-4/BDR --reason \"{}\"", reason));
}

}  // namespace

void add_operator_commands(CLI::App& app, int& exit_code) {
  add_decision(app, exit_code, "approve", "Make a waiting version the champion",
               "seen on two passes");
  add_decision(app, exit_code, "reject", "Refuse a waiting version", "a heater test fell into it");
  add_decision(app, exit_code, "withdraw",
               "Take a version that is or was champion out of use for ever", "wrong sensor");
  add_order(app, exit_code, "hold", "hold", "Keep the champion, whatever new windows give",
            "training until Friday");
  add_order(app, exit_code, "release", "release", "End a hold", "training is over");
  add_order(app, exit_code, "identify-now", "identify_now",
            "Try the window that ends where telemetry ends, without waiting for the next slide",
            "after the manoeuvre");
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* rollback =
      add(app, exit_code, arguments, "rollback", "roll_back", "Return to an earlier champion");
  rollback->add_option("--to", arguments->version, "to this version (the previous champion)")
      ->check(CLI::PositiveNumber);
  rollback->add_option("--reason", arguments->options.reason, "why, kept with the decision");
  footer(*rollback, "CBERS-4/BDR --to 5 --reason \"odd in eclipse\"");
}

}  // namespace reident::cli
