#include "service/web/orders.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "service/security/command_signature.hpp"
#include "service/support/log.hpp"

namespace reident::web {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr auto reply_within = 10s;
constexpr auto look_around = 10ms;   // for a service to be discovered
constexpr auto again_after = 200ms;  // without a reply
constexpr std::size_t replies_at_most = 64, most_waiting = 16;
constexpr std::size_t requester_length = 32;  // of the page's part, hexadecimal

constexpr std::array roles = {std::pair{std::string_view("hold"), Role::controller},
                              std::pair{std::string_view("release"), Role::controller},
                              std::pair{std::string_view("identify_now"), Role::controller},
                              std::pair{std::string_view("approve"), Role::approver},
                              std::pair{std::string_view("reject"), Role::approver},
                              std::pair{std::string_view("roll_back"), Role::approver},
                              std::pair{std::string_view("withdraw"), Role::approver}};

std::string text_in(const Json& body, const char* key) {
  const auto found = body.find(key);
  if (found == body.end() || found->is_null()) return "";
  if (!found->is_string()) throw BadRequest(fmt::format("{} is a text", key));
  return found->get<std::string>();
}

/// A number of 64 bits as text; 0 for none.
std::int64_t number_in(const Json& body, const char* key) {
  const std::string text = text_in(body, key);
  if (text.empty()) return 0;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1)
    throw BadRequest(fmt::format("{} is a whole number above 0, as text", key));
  return number;
}

}  // namespace

std::optional<Role> role_for(std::string_view action) {
  for (const auto& [name, role] : roles)
    if (name == action) return role;
  return std::nullopt;
}

PageOrder read_order(const std::string& text, const std::string& actor) {
  const Json body = Json::parse(text, nullptr, false);
  if (!body.is_object()) throw BadRequest("the order is no JSON object");
  PageOrder order;
  storage::Command& command = order.command;
  const std::string requester = text_in(body, "requester");
  const bool is_requester = requester.size() == requester_length &&
                            std::all_of(requester.begin(), requester.end(), [](char c) {
                              return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
                            });
  if (!is_requester)
    throw BadRequest("requester is 32 hexadecimal digits, drawn once for each form");
  command.requester = "reident-web:" + requester;
  command.request = 1;
  command.action = text_in(body, "action");
  command.spacecraft = text_in(body, "spacecraft");
  command.equipment = text_in(body, "equipment");
  command.version = number_in(body, "version");
  command.actor = actor;
  command.reason = text_in(body, "reason");
  if (body.contains("champion")) order.champion = number_in(body, "champion");
  return order;
}

OrderDesk::OrderDesk(const dds::Endpoint& endpoint, std::string service)
    : service_(std::move(service)),
      participant_(endpoint),
      commands_(participant_),
      replies_(participant_),
      ready_(participant_),
      waiting_(most_waiting) {
  ready_.attach(replies_);
  thread_ = std::thread([this] { run(); });
}

OrderDesk::~OrderDesk() {
  waiting_.close();
  thread_.join();
}

void OrderDesk::send(const storage::Command& command, const Respond& respond) {
  later([this, command] { return reply_to(command); }, respond);
}

void OrderDesk::later(std::function<HttpResponse()> work, const Respond& respond) {
  if (!waiting_.offer({std::move(work), respond}))
    respond(problem(503, "busy", "too many orders wait; send this one again"));
}

void OrderDesk::run() {
  while (const auto next = waiting_.next()) {
    try {
      next->respond(next->work());
    } catch (const std::exception& error) {
      log::error("web", "an order failed", {{"error", error.what()}});
      next->respond(problem(503, "failed", error.what()));
    }
  }
}

HttpResponse OrderDesk::reply_to(const storage::Command& command) {
  if (const auto outcome = ask(command))
    return json_response({{"ok", outcome->ok}, {"reply", outcome->reply}});
  return problem(503, "no_reply",
                 fmt::format("service {} did not reply within 10 s; send the order again: it is "
                             "carried out once",
                             service_));
}

std::optional<storage::CommandOutcome> OrderDesk::ask(const storage::Command& command) {
  CommandRequest request{command, service_};
  if (const auto material = participant_.material()) security::sign(request, *material);
  const auto deadline = SteadyClock::now() + reply_within;
  std::optional<SteadyClock::time_point> sent;
  std::optional<storage::CommandOutcome> outcome;
  for (auto now = SteadyClock::now(); !outcome && now < deadline; now = SteadyClock::now()) {
    const bool is_heard = commands_.matched_readers() > 0 && replies_.matched_writers() > 0;
    if (is_heard && (!sent || now - *sent >= again_after)) {
      commands_.write(request);
      sent = now;
    }
    ready_.wait(look_around);
    replies_.take(replies_at_most, [&](CommandReply&& reply) {
      if (reply.requester == command.requester && reply.request == command.request)
        outcome = std::move(reply.outcome);
    });
    if (waiting_.is_closed()) return std::nullopt;
  }
  return outcome;
}

}  // namespace reident::web
