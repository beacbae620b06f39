#include "service/daemon/command_desk.hpp"

#include <chrono>
#include <utility>

#include "service/security/command_signature.hpp"
#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t requests_at_most = 16;

}  // namespace

CommandDesk::CommandDesk(dds::Participant& participant, std::string service, Clock clock,
                         std::string pair, std::function<bool()> leads)
    : participant_(participant),
      service_(std::move(service)),
      clock_(std::move(clock)),
      pair_(std::move(pair)),
      leads_(std::move(leads)),
      commands_(participant),
      replies_(participant),
      ready_(participant) {
  ready_.attach(commands_);
}

std::variant<storage::Command, std::string> CommandDesk::command_of(
    const CommandRequest& request) const {
  const auto material = participant_.material();
  if (!material) return request.command;
  auto actor = security::actor_of(request, *material, clock_());
  if (auto* why = std::get_if<std::string>(&actor)) return std::move(*why);
  storage::Command command = request.command;
  command.actor = std::get<security::Actor>(std::move(actor)).name;
  return command;
}

void CommandDesk::answer(const CommandRequest& request, const Execute& execute) {
  if (!is_meant(request.service)) return;
  const auto checked = command_of(request);
  const auto* why = std::get_if<std::string>(&checked);
  const storage::Command& command = why ? request.command : std::get<storage::Command>(checked);
  std::optional<storage::CommandOutcome> outcome;
  try {
    outcome = why ? storage::CommandOutcome{false, *why} : execute(command);
  } catch (const storage::Error& error) {
    // Not kept, so that the same command can succeed later.
    outcome = {false, error.what()};
  }
  if (!outcome) return;
  log::info(
      "command", outcome->ok ? "done" : "refused",
      {{"action", command.action},
       {"equipment", command.spacecraft.empty() ? command.equipment
                                                : command.spacecraft + "/" + command.equipment},
       {"version", command.version},
       {"actor", command.actor},
       {"reply", outcome->reply}});
  replies_.write({command.requester, command.request, *std::move(outcome)});
}

void CommandDesk::run(const Execute& execute) {
  while (!stopping_) {
    ready_.wait(dds::idle_wait);
    std::vector<CommandRequest> requests;
    do {
      requests.clear();
      commands_.take(
          requests_at_most,
          [&](CommandRequest&& request) { requests.push_back(std::move(request)); },
          [](const CommandRequest& request, const std::string& reason) {
            log::warning("command", "refused a malformed command",
                         {{"requester", request.command.requester}, {"reason", reason}});
          });
      for (const CommandRequest& request : requests)
        if (!stopping_) answer(request, execute);
    } while (!requests.empty() && !stopping_);
  }
}

void CommandDesk::stop() {
  stopping_ = true;
  ready_.wake();
}

}  // namespace reident
