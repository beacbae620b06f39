#include "service/daemon/command_desk.hpp"

#include <chrono>
#include <utility>

#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t requests_at_most = 16;

}  // namespace

CommandDesk::CommandDesk(dds::Participant& participant, std::string service,
                         std::function<bool()> is_one_of_all)
    : service_(std::move(service)),
      is_one_of_all_(std::move(is_one_of_all)),
      commands_(participant),
      replies_(participant),
      ready_(participant) {
  ready_.attach(commands_);
}

void CommandDesk::answer(const CommandRequest& request, const Execute& execute) {
  if (!is_meant(request.service)) return;
  const storage::Command& command = request.command;
  std::optional<storage::CommandOutcome> outcome;
  try {
    outcome = execute(command);
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
    ready_.wait(dds::stop_check_interval);
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
