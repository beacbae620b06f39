#include "service/daemon/history_desk.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t questions_at_most = 16;
// A page that a console does not take is given up by the middleware sooner than that.
constexpr auto patience = 2s;

}  // namespace

HistoryDesk::HistoryDesk(dds::Participant& participant, std::string service,
                         std::function<bool()> is_one_of_all)
    : service_(std::move(service)),
      is_one_of_all_(std::move(is_one_of_all)),
      requests_(participant),
      replies_(participant),
      ready_(participant) {
  ready_.attach(requests_);
}

void HistoryDesk::reply(const HistoryRequest& request,
                        std::variant<HistoryPage, history::BadQuestion> answer) {
  HistoryReply reply;
  reply.slot = request.slot;
  reply.requester = request.requester;
  reply.request = request.request;
  reply.service = service_;
  reply.ok = std::holds_alternative<HistoryPage>(answer);
  if (reply.ok)
    reply.page = std::get<HistoryPage>(std::move(answer));
  else
    reply.reason = std::move(std::get<history::BadQuestion>(answer).reason);
  const auto deadline = SteadyClock::now() + patience;
  replies_.write(reply, [&] { return stopping_ || SteadyClock::now() >= deadline; });
}

void HistoryDesk::run(const Answer& answer) {
  using Asked = std::pair<HistoryRequest, std::string>;  // what is malformed, or nothing
  while (!stopping_) {
    ready_.wait(dds::idle_wait);
    std::vector<Asked> asked;
    do {
      asked.clear();
      requests_.take(
          questions_at_most,
          [&](HistoryRequest&& request) { asked.emplace_back(std::move(request), ""); },
          [&](const HistoryRequest& request, const std::string& reason) {
            asked.emplace_back(request, reason);
          });
      for (const auto& [request, malformed] : asked) {
        if (stopping_) return;
        if (!is_meant(request.service)) continue;
        if (!malformed.empty()) {
          reply(request, history::BadQuestion{malformed + "; ask again without that"});
          continue;
        }
        try {
          reply(request, answer(request.query));
        } catch (const storage::Error& error) {
          log::warning("history", "a question could not be answered",
                       {{"subject", request.query.subject}, {"error", error.what()}});
          reply(request, history::BadQuestion{error.what()});
        }
      }
    } while (!asked.empty() && !stopping_);
  }
}

void HistoryDesk::stop() {
  stopping_ = true;
  ready_.wake();
}

}  // namespace reident
