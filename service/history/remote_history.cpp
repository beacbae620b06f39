#include "service/history/remote_history.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "service/support/program_identity.hpp"

namespace reident::history {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto look_around = 10ms;  // for a service to be discovered
constexpr Clock::duration first_patience = 200ms;
constexpr Clock::duration last_patience = 3s;
constexpr Clock::duration longest_wait = 200ms;  // until it is said that it goes on
constexpr std::size_t take_at_most = 16;
constexpr std::size_t slots = 1024;  // idl/README.md

}  // namespace

RemoteHistory::RemoteHistory(dds::Participant& participant, std::string service, Waits waits)
    : wanted_service_(std::move(service)),
      waits_(waits ? std::move(waits) : [](bool) {}),
      requests_(participant),
      replies_(participant),
      ready_(participant) {
  ready_.attach(replies_);
  request_.requester = unique_program_name("history");
  request_.slot = static_cast<std::uint16_t>(std::hash<std::string>{}(request_.requester) % slots);
  request_.service = wanted_service_;
}

std::optional<HistoryReply> RemoteHistory::take() {
  std::optional<HistoryReply> mine;
  std::string malformed;
  const auto is_mine = [this](const HistoryReply& reply) {
    return reply.requester == request_.requester && reply.request == request_.request &&
           (request_.service.empty() || reply.service == request_.service);
  };
  replies_.take(
      take_at_most,
      [&](HistoryReply&& reply) {
        if (is_mine(reply)) mine = std::move(reply);
      },
      [&](const HistoryReply& reply, const std::string& reason) {
        if (is_mine(reply)) mine = reply, malformed = reason;
      });
  if (mine && !malformed.empty()) {
    mine->ok = false;
    mine->reason = "the service sent a page that breaks the contract: " + malformed +
                   "; bring this program and the service to the same version";
  }
  return mine;
}

std::variant<HistoryPage, RemoteHistory::Failure> RemoteHistory::page(
    const HistoryQuery& query, std::chrono::milliseconds timeout) {
  ++request_.request;
  request_.query = query;
  const auto deadline = Clock::now() + timeout;
  auto send_at = Clock::now();
  auto patience = first_patience;
  bool was_asked = false;
  for (auto now = Clock::now(); now < deadline; now = Clock::now()) {
    const bool is_heard = requests_.matched_readers() > 0 && replies_.matched_writers() > 0;
    if (is_heard && now >= send_at) {
      requests_.write(request_);
      send_at = now + std::exchange(patience, std::min(2 * patience, last_patience));
      was_asked = true;
    }
    ready_.wait(std::min<Clock::duration>(
        {is_heard ? send_at - now : look_around, deadline - now, longest_wait}));
    auto reply = take();
    waits_(!reply);
    if (reply) {
      request_.service = reply->service;
      if (reply->ok) return std::move(reply->page);
      return Failure{Error::Kind::refused, std::move(reply->reason)};
    }
  }
  waits_(false);
  request_.service = wanted_service_;  // another one may have taken over
  return Failure{
      Error::Kind::no_answer,
      fmt::format("{} {} within {:g} s",
                  wanted_service_.empty() ? "no service" : "no service " + wanted_service_,
                  was_asked ? "answered" : "was found",
                  std::chrono::duration<double>(timeout).count())};
}

}  // namespace reident::history
