// The thread between operators on DDS and the registry: it hears their commands, has each executed,
// and replies.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "service/dds/dds.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

class CommandDesk {
 public:
  /// Executes and publishes; absent where the service stops before it can be executed: the command
  /// is sent again to the next run.
  using Execute =
      std::function<std::optional<storage::CommandOutcome>(const storage::Command& command)>;

  /// Hears commands to `service` and those to every service, these while `is_one_of_all`
  /// answers true (without it always). The participant must outlive it. Throws dds::Error.
  CommandDesk(dds::Participant& participant, std::string service,
              std::function<bool()> is_one_of_all = {});

  /// The thread's body: until stop().
  void run(const Execute& execute);
  void stop();

 private:
  void answer(const CommandRequest& request, const Execute& execute);

  bool is_meant(const std::string& service) const {
    return service.empty() ? !is_one_of_all_ || is_one_of_all_() : service == service_;
  }

  const std::string service_;
  const std::function<bool()> is_one_of_all_;
  dds::Reader<CommandRequest> commands_;
  dds::Writer<CommandReply> replies_;
  dds::WaitSet ready_;
  std::atomic<bool> stopping_ = false;
};

}  // namespace reident
