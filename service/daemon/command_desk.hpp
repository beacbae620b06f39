// The thread between operators on DDS and the registry: it hears their commands, has each executed,
// and replies.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "service/daemon/window_feed.hpp"
#include "service/dds/dds.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

class CommandDesk {
 public:
  /// Executes and publishes; absent where the service stops before it can be executed: the command
  /// is sent again to the next run.
  using Execute =
      std::function<std::optional<storage::CommandOutcome>(const storage::Command& command)>;

  /// Hears commands to `service`, and those to every service or to `pair` while `leads` answers
  /// true (without it always). The participant must outlive it; where it is secured, signed
  /// commands alone are executed, and the actor is the one who signed. Throws dds::Error.
  CommandDesk(dds::Participant& participant, std::string service, Clock clock,
              std::string pair = {}, std::function<bool()> leads = {});

  /// The thread's body: until stop().
  void run(const Execute& execute);
  void stop();

 private:
  void answer(const CommandRequest& request, const Execute& execute);
  /// The command with who ordered it, or why it is not executed.
  std::variant<storage::Command, std::string> command_of(const CommandRequest& request) const;

  bool is_meant(const std::string& service) const {
    return service == service_ || ((service.empty() || service == pair_) && (!leads_ || leads_()));
  }

  const dds::Participant& participant_;
  const std::string service_;
  const Clock clock_;
  const std::string pair_;
  const std::function<bool()> leads_;
  dds::Reader<CommandRequest> commands_;
  dds::Writer<CommandReply> replies_;
  dds::WaitSet ready_;
  std::atomic<bool> stopping_ = false;
};

}  // namespace reident
