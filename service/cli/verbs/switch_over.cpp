#include <fmt/format.h>

#include "service/cli/operate.hpp"
#include "service/cli/service_choice.hpp"
#include "service/cli/verb.hpp"

namespace reident::cli::switch_over_verb {
namespace {

constexpr double max_timeout_s = 1e6;

std::function<int()> declare(CLI::App& command) {
  const auto options = std::make_shared<OperatorOptions>();
  options->actor = login_name();
  command.add_option("--actor", options->actor, "the operator's name, kept with the command")
      ->capture_default_str();
  command.add_option("--reason", options->reason, "why, kept with it");
  add_database_options(command, options->database);
  command.add_option("--domain", options->domain, "DDS domain")->check(CLI::Range(0, 230));
  command.add_option("--partition", options->partition, "DDS partition");
  add_service_option(command, options->service);
  command.add_option("--timeout", options->timeout_s, "seconds to wait for the service")
      ->check(CLI::Range(0.0, max_timeout_s))
      ->capture_default_str();
  command.add_flag("--json", options->json, "one JSON object with the reply");
  command.footer(
      "The service of the pair that leads gives leadership to the other one, which has all that it "
      "has by then. 'reident status' shows both.\n"
      "Example:\n"
      "  reident switch-over --reason \"new disk\" --config reident.toml\n"
      "Exit status: 2 when it was refused, with the reason; 4 when no service answered in time.");
  return [options] { return operate(*options, {"switch_over", "", "", 0}); };
}

const VerbRegistration registered({"switch-over",
                                   "Give leadership of a pair of services to the other one",
                                   WorksOn::decision, declare});

}  // namespace
}  // namespace reident::cli::switch_over_verb
