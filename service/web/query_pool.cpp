#include "service/web/query_pool.hpp"

#include <utility>

#include <sys/resource.h>

#include "service/support/log.hpp"

namespace reident::web {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::seconds longest_answer{10};
constexpr int niceness = 5;  // the service's threads come first

}  // namespace

void Stored::check_time() const {
  if (SteadyClock::now() > deadline_)
    throw TooSlow("the answer takes too long; ask for a shorter range, or again later");
}

QueryPool::QueryPool(std::filesystem::path database, unsigned threads, std::size_t queue)
    : database_(std::move(database)), waiting_(queue) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

QueryPool::~QueryPool() {
  waiting_.close();
  for (std::thread& thread : threads_) thread.join();
}

void QueryPool::ask(Question question, bool compressed, Respond respond) {
  Waiting waiting{std::move(question), compressed, std::move(respond)};
  if (waiting_.offer(std::move(waiting))) return;
  HttpResponse busy = problem(503, "busy", "too many questions wait; ask again in a second");
  busy.headers.emplace_back("Retry-After", "1");
  waiting.respond(std::move(busy));
}

void QueryPool::run() {
  ::setpriority(PRIO_PROCESS, 0, niceness);  // of this thread
  while (const auto next = waiting_.next()) {
    HttpResponse response = answer(next->question);
    if (next->compressed) compress(response);
    next->respond(std::move(response));
  }
}

HttpResponse QueryPool::answer(const Question& question) {
  try {
    storage::Database database(database_, storage::Database::Mode::read_only);
    return question(Stored(database, pieces_, SteadyClock::now() + longest_answer));
  } catch (const BadRequest& mistake) {
    return problem(mistake.status, mistake.status == 404 ? "not_found" : "question",
                   mistake.what());
  } catch (const TooSlow& error) {
    return problem(503, "too_slow", error.what());
  } catch (const storage::Error& error) {
    log::warning("web", "a question could not be answered", {{"error", error.what()}});
    return problem(503, "database", error.what());
  } catch (const std::exception& error) {
    log::error("web", "a question failed", {{"error", error.what()}});
    return problem(500, "failed", error.what());
  }
}

}  // namespace reident::web
