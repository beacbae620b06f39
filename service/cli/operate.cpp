#include "service/cli/operate.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <pwd.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "service/cli/command_sender.hpp"
#include "service/cli/config_options.hpp"
#include "service/cli/service_choice.hpp"
#include "service/operations/commands.hpp"
#include "service/security/command_signature.hpp"
#include "service/support/program_identity.hpp"
#include "service/support/progress.hpp"
#include "service/support/terminal.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli {
namespace {

using SteadyClock = std::chrono::steady_clock;
using storage::Command;
using storage::CommandOutcome;

/// How long a service is waited for until the database is tried again.
constexpr auto turn = std::chrono::milliseconds(300);
/// Without an answer for so long a terminal shows how long it is waited.
constexpr auto quiet_wait = std::chrono::seconds(2);

struct Target {
  std::optional<std::filesystem::path> database;
  dds::Endpoint endpoint;
  std::string service;  // addressee() of the configuration
  bool is_pair = false;
  CommandContext context;
  std::string actor;  // who the certificate says, on a secured domain
};

std::variant<Target, Refusal> target_of(const OperatorOptions& options) {
  Target target;
  target.endpoint.security = security::folder_of_environment();
  if (options.database.database) {
    target.database = *options.database.database;
  } else {
    auto chosen = chosen_config(options.database.config);
    if (auto* refusal = std::get_if<Refusal>(&chosen)) return *refusal;
    if (const auto& config = std::get<std::optional<Config>>(chosen)) {
      target = {config->database,      endpoint_of(*config),        addressee(*config),
                !config->pair.empty(), {equipment_of(*config), {}}, {}};
    } else if (!options.domain && !options.partition) {
      return Refusal{
          fmt::format("there is no {} here; name the service's configuration with "
                      "--config FILE, its database with --database FILE, or its DDS "
                      "domain and partition",
                      default_config_file)};
    }
  }
  target.endpoint.domain = options.domain.value_or(target.endpoint.domain);
  target.endpoint.partition = options.partition.value_or(target.endpoint.partition);
  return target;
}

struct Answer {
  CommandOutcome outcome;
  bool by_service = false;
};
/// Refused where no database of ours can be used.
using Asked = std::variant<Answer, Refusal>;

/// Absent where the database is not here or another process holds it; `why` says which.
std::optional<Asked> execute_on_file(const Target& target, const Command& command,
                                     std::string& why) {
  std::error_code error;
  if (!target.database || !std::filesystem::exists(*target.database, error)) {
    why = target.database ? fmt::format("there is no database {}", target.database->string())
                          : "no database was named";
    return std::nullopt;
  }
  try {
    storage::Database database(*target.database, storage::Database::Mode::update);
    storage::Registry registry(database);
    if (target.is_pair || !registry.journal().is_of(target.service)) {
      why = fmt::format(
          "{} is the database of a pair of services, whose leader alone carries out commands",
          target.database->string());
      return std::nullopt;
    }
    Command own = command;
    if (!target.actor.empty()) own.actor = target.actor;
    return Answer{execute(own, registry, target.context, utc_now()), false};
  } catch (const storage::Error& failure) {
    why = failure.what();
    using Kind = storage::Error::Kind;
    // Who holds it is the service that is to answer: it must not be stopped.
    if (failure.kind() == Kind::locked) why = why.substr(0, why.find("; "));
    if (failure.kind() == Kind::locked || failure.kind() == Kind::read_only) return std::nullopt;
    if (failure.kind() == Kind::cannot_open || failure.kind() == Kind::newer_schema)
      return Refusal{why};
    throw;
  }
}

/// Names the version that a rollback goes back to, where the database can be read: of two operators
/// who roll back at once the second is then refused, and does not go back one more.
void name_the_version(const Target& target, Command& command) {
  if (command.action != "roll_back" || command.version != 0 || !target.database) return;
  try {
    storage::Database database(*target.database, storage::Database::Mode::read_only);
    const storage::Registry registry(database);
    std::vector<storage::EquipmentName> meant;
    for (const storage::EquipmentName& one : registry.equipment())
      if (one.equipment == command.equipment &&
          (command.spacecraft.empty() || one.spacecraft == command.spacecraft))
        meant.push_back(one);
    if (meant.size() != 1) return;  // the reply says what is wrong
    const auto previous = registry.previous_champion(meant[0].spacecraft, meant[0].equipment);
    if (previous) command.version = previous->number;
  } catch (const storage::Error&) {
    // Not readable here: whoever executes the command finds the version.
  }
}

/// Absent when the time ran out; `why` says what kept the file.
std::optional<Asked> ask(const Target& target, const OperatorOptions& options,
                         const Command& command, std::string& why) {
  if (!options.service)
    if (auto asked = execute_on_file(target, command, why)) return asked;
  const auto deadline = SteadyClock::now() + std::chrono::duration_cast<SteadyClock::duration>(
                                                 std::chrono::duration<double>(options.timeout_s));
  const auto began = SteadyClock::now();
  Progress progress;
  std::optional<CommandSender> sender;
  while (SteadyClock::now() < deadline) {
    const std::chrono::duration<double> waited = SteadyClock::now() - began;
    if (waited > quiet_wait)
      progress.update(waited.count() / options.timeout_s,
                      sender ? "no answer of the service yet" : "no service was found yet");
    if (!sender) {
      const auto service =
          chosen_service(target.endpoint, options.service, target.service, heartbeat_wait);
      if (const auto* refusal = std::get_if<Refusal>(&service)) return *refusal;
      if (const std::string& name = addressee(std::get<ServiceStatus>(service)); !name.empty())
        sender.emplace(target.endpoint, CommandRequest{command, name});
    }
    if (sender)
      if (const auto outcome = sender->wait(turn)) return Answer{*outcome, true};
    // The service may have ended; what it did already, the database knows by the request.
    if (auto asked = execute_on_file(target, command, why)) return asked;
  }
  return std::nullopt;
}

int report_timeout(const Target& target, const OperatorOptions& options, const std::string& why) {
  print_error(
      "reident: no service answered on domain {}, partition {} within {:g} s, and {}; check "
      "that the domain and the partition are the service's, and with 'reident history' that "
      "nothing was done{}",
      target.endpoint.domain, target.endpoint.partition, options.timeout_s, why,
      why_unheard(target.endpoint, options.database.config));
  return exit_timed_out;
}

/// On a secured domain the actor is who the certificate says, also where the file itself is worked
/// on. Refused where the files are wrong, or of a role that may not order.
std::optional<Refusal> name_the_actor(Target& target, const Command& command) {
  if (target.endpoint.security.empty()) return std::nullopt;
  const auto read = security::read_material(target.endpoint.security, utc_now());
  if (const auto* mistakes = std::get_if<std::vector<std::string>>(&read))
    return Refusal{mistakes->front()};
  const auto& material = std::get<security::Material>(read);
  CommandRequest request{command, target.service};
  security::sign(request, material);
  auto actor = security::actor_of(request, material, utc_now());
  if (const auto* why = std::get_if<std::string>(&actor)) return Refusal{*why};
  target.actor = std::get<security::Actor>(std::move(actor)).name;
  return std::nullopt;
}

void print_json(const Command& command, const std::string& actor, const Answer& answer) {
  const nlohmann::ordered_json object = {
      {"ok", answer.outcome.ok},
      {"reply", answer.outcome.reply},
      {"by", answer.by_service ? "service" : "file"},
      {"action", command.action},
      {"spacecraft", command.spacecraft},
      {"equipment", command.equipment},
      {"version",
       command.version == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(command.version)},
      {"actor", actor},
      {"reason", command.reason}};
  fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

std::string login_name() {
  std::array<char, 256> name{};
  if (::getlogin_r(name.data(), name.size()) == 0) return name.data();
  const passwd* user = ::getpwuid(::geteuid());
  return user ? user->pw_name : "";
}

int operate(const OperatorOptions& options, const OperatorOrder& order) {
  auto found = target_of(options);
  if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
  Target& target = std::get<Target>(found);
  Command command{unique_program_name("reident"),
                  1,
                  order.action,
                  order.spacecraft,
                  order.equipment,
                  order.version,
                  options.actor,
                  options.reason};
  name_the_version(target, command);
  if (const auto refusal = name_the_actor(target, command)) return refuse(*refusal);
  std::string why;
  const auto asked = ask(target, options, command, why);
  if (!asked) return report_timeout(target, options, why);
  if (const auto* refusal = std::get_if<Refusal>(&*asked)) return refuse(*refusal);
  const Answer& answer = std::get<Answer>(*asked);
  if (options.json) {
    print_json(command, target.actor.empty() ? command.actor : target.actor, answer);
    return answer.outcome.ok ? exit_done : exit_impossible;
  }
  if (!answer.outcome.ok) return refuse({answer.outcome.reply});
  fmt::print("{}{}\n", answer.outcome.reply,
             answer.by_service ? "" : " (no service runs: done in its database)");
  return exit_done;
}

}  // namespace reident::cli
