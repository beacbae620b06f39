// A command on DDS and its reply.
#pragma once

#include <chrono>
#include <optional>

#include "service/dds/dds.hpp"

namespace reident::cli {

/// Sends one request again and again: a reply can be lost to a reader that its writer has not
/// discovered yet, and a service that is asked twice answers twice the same.
class CommandSender {
 public:
  /// Throws dds::Error.
  CommandSender(const dds::Endpoint& endpoint, CommandRequest request);

  /// The reply; absent when `timeout` passed without one.
  std::optional<storage::CommandOutcome> wait(std::chrono::milliseconds timeout);

 private:
  dds::Participant participant_;
  dds::Writer<CommandRequest> commands_;
  dds::Reader<CommandReply> replies_;
  dds::WaitSet ready_;
  CommandRequest request_;
  std::optional<std::chrono::steady_clock::time_point> sent_;
};

}  // namespace reident::cli
