#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/cli/operate.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/service_choice.hpp"
#include "service/cli/verb.hpp"

namespace reident::cli::operator_verbs {
namespace {

constexpr double max_timeout_s = 1e6;

/// What the words of an order name in addition to the equipment.
enum class Names { no_version, a_version, maybe_a_version };

struct Arguments {
  Names names = Names::no_version;
  OperatorOptions options;
  std::string subject;
  std::int64_t version = 0;
  std::string alarm;  // of acknowledge
};

int run(const Arguments& arguments, const std::string& action) {
  const auto parsed = parse_subject(arguments.subject);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return refuse(*refusal);
  const Subject& subject = std::get<Subject>(parsed);
  if (subject.version && arguments.names == Names::no_version)
    return refuse({fmt::format("{} names a version; {} is about the equipment alone",
                               arguments.subject, action)});
  if (subject.version && arguments.version != 0 && *subject.version != arguments.version)
    return refuse({fmt::format("{} and {} are two versions; name one", arguments.subject,
                               arguments.version)});
  const std::int64_t version = subject.version.value_or(arguments.version);
  if (version == 0 && arguments.names == Names::a_version)
    return refuse({fmt::format("{} names no version; write {}@NUMBER", arguments.subject,
                               arguments.subject)});
  return operate(arguments.options, {action, subject.spacecraft, subject.equipment, version});
}

/// What all of them have; the caller adds its own. Returns what the verb does.
std::function<int()> declare_common(CLI::App& command, const std::shared_ptr<Arguments>& arguments,
                                    const std::string& action) {
  OperatorOptions& options = arguments->options;
  options.actor = login_name();
  command
      .add_option("equipment", arguments->subject,
                  "EQUIPMENT or SPACECRAFT/EQUIPMENT; with @VERSION where a version is named")
      ->required();
  command.add_option("--actor", options.actor, "the operator's name, kept with the decision")
      ->capture_default_str();
  add_database_options(command, options.database);
  command.add_option("--domain", options.domain, "DDS domain")->check(CLI::Range(0, 230));
  command.add_option("--partition", options.partition, "DDS partition");
  add_service_option(command, options.service);
  command.add_option("--timeout", options.timeout_s, "seconds to wait for the service")
      ->check(CLI::Range(0.0, max_timeout_s))
      ->capture_default_str();
  command.add_flag("--json", options.json, "one JSON object with the reply");
  return [arguments, action] { return run(*arguments, action); };
}

void footer(CLI::App& command, const std::string& example) {
  command.footer(fmt::format(
      "Example:\n  reident {} {}\n"
      "Exit status: 2 when it was refused, with the reason; 4 when no service answered in time.",
      command.get_name(), example));
}

/// A decision about a version that is named.
Verb decision(std::string_view name, std::string_view purpose, std::string example_reason) {
  return {name, purpose, WorksOn::decision, [name, example_reason](CLI::App& command) {
            const auto arguments = std::make_shared<Arguments>();
            arguments->names = Names::a_version;
            auto work = declare_common(command, arguments, std::string(name));
            command
                .add_option("version", arguments->version,
                            "number of the version, where @VERSION does not say it")
                ->check(above_zero());
            command
                .add_option("--reason", arguments->options.reason, "why, kept with the decision")
                ->required();
            footer(command, fmt::format("CBERS-4/BDR 7 --reason \"{}\"", example_reason));
            return work;
          }};
}

/// An order about an equipment.
Verb order(std::string_view name, std::string action, std::string_view purpose,
           std::string example_reason) {
  return {name, purpose, WorksOn::decision, [action, example_reason](CLI::App& command) {
            const auto arguments = std::make_shared<Arguments>();
            auto work = declare_common(command, arguments, action);
            command.add_option("--reason", arguments->options.reason, "why, kept with it");
            footer(command, fmt::format("CBERS-4/BDR --reason \"{}\"", example_reason));
            return work;
          }};
}

std::function<int()> declare_rollback(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  arguments->names = Names::maybe_a_version;
  auto work = declare_common(command, arguments, "roll_back");
  command.add_option("--to", arguments->version, "to this version (the previous champion)")
      ->check(above_zero());
  command.add_option("--reason", arguments->options.reason, "why, kept with the decision");
  footer(command, "CBERS-4/BDR --to 5 --reason \"odd in eclipse\"");
  return work;
}

int run_acknowledge(const Arguments& arguments) {
  const std::string action = "acknowledge " + arguments.alarm;
  return arguments.subject.empty() ? operate(arguments.options, {action, "", "", 0})
                                   : run(arguments, action);
}

std::function<int()> declare_acknowledge(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command
      .add_option("alarm", arguments->alarm,
                  "code of an alarm that is raised, as 'reident overview' shows it")
      ->required();
  declare_common(command, arguments, "");
  command.get_option("equipment")
      ->required(false)
      ->description("EQUIPMENT, SPACECRAFT/EQUIPMENT or SPACECRAFT (all that have the alarm)");
  command.add_option("--reason", arguments->options.reason, "what is done about it, kept with it");
  footer(command, "no_telemetry CBERS-4/BDR --reason \"the station is in maintenance\"");
  return [arguments] { return run_acknowledge(*arguments); };
}

const VerbRegistration registered[] = {
    VerbRegistration({"acknowledge", "Note who has seen an alarm, so that it asks nobody to act",
                      WorksOn::decision, declare_acknowledge}),
    VerbRegistration(
        decision("approve", "Make a waiting version the champion", "seen on two passes")),
    VerbRegistration(decision("reject", "Refuse a waiting version", "a heater test fell into it")),
    VerbRegistration(decision(
        "withdraw", "Take a version that is or was champion out of use for ever", "wrong sensor")),
    VerbRegistration(order("hold", "hold", "Keep the champion, whatever new windows give",
                           "training until Friday")),
    VerbRegistration(order("release", "release", "End a hold", "training is over")),
    VerbRegistration(
        order("identify-now", "identify_now",
              "Try the window that ends where telemetry ends, without waiting for the next slide",
              "after the manoeuvre")),
    VerbRegistration(
        {"rollback", "Return to an earlier champion", WorksOn::decision, declare_rollback}),
};

}  // namespace
}  // namespace reident::cli::operator_verbs
