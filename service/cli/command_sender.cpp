#include "service/cli/command_sender.hpp"

#include <utility>

#include "service/security/command_signature.hpp"

namespace reident::cli {
namespace {

using SteadyClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto look_around = 10ms;   // for a service to be discovered
constexpr auto again_after = 200ms;  // without a reply
constexpr std::size_t take_at_most = 64;

}  // namespace

CommandSender::CommandSender(const dds::Endpoint& endpoint, CommandRequest request)
    : participant_(endpoint),
      commands_(participant_),
      replies_(participant_),
      ready_(participant_),
      request_(std::move(request)) {
  ready_.attach(replies_);
  if (const auto material = participant_.material()) security::sign(request_, *material);
}

std::optional<storage::CommandOutcome> CommandSender::wait(std::chrono::milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  std::optional<storage::CommandOutcome> outcome;
  for (auto now = SteadyClock::now(); !outcome && now < deadline; now = SteadyClock::now()) {
    const bool is_heard = commands_.matched_readers() > 0 && replies_.matched_writers() > 0;
    if (is_heard && (!sent_ || now - *sent_ >= again_after)) {
      commands_.write(request_);
      sent_ = now;
    }
    ready_.wait(look_around);
    replies_.take(take_at_most, [&](CommandReply&& reply) {
      if (reply.requester == request_.command.requester &&
          reply.request == request_.command.request)
        outcome = std::move(reply.outcome);
    });
  }
  return outcome;
}

}  // namespace reident::cli
