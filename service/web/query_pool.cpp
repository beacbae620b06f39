#include "service/web/query_pool.hpp"

#include <algorithm>
#include <ctime>
#include <sched.h>
#include <utility>

#include <sys/resource.h>

#include "service/support/log.hpp"

namespace reident::web {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::seconds longest_answer{10};
// The service's threads come first.
constexpr int usual_niceness = 5;

/// Processor time of this thread [s].
double processor_time() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace

void Stored::check_time() const {
  if (SteadyClock::now() > deadline_)
    throw TooSlow("the answer takes too long; ask for a shorter range, or again later");
}

bool Allowance::is_left(Clock::time_point now) {
  const MutexLock lock(mutex_);
  left_s_ =
      std::min(burst_s, left_s_ + share * std::chrono::duration<double>(now - counted_).count());
  counted_ = now;
  return left_s_ > 0;
}

void Allowance::take(double seconds) {
  const MutexLock lock(mutex_);
  left_s_ -= seconds;
}

QueryPool::QueryPool(std::filesystem::path database, unsigned threads, std::size_t queue)
    : database_(std::move(database)), allowance_(SteadyClock::now()), usual_(queue), last_(queue) {
  for (unsigned i = 0; i < threads; ++i) {
    usual_.threads.emplace_back([this] { run(usual_); });
    last_.threads.emplace_back([this] { run(last_); });
  }
}

QueryPool::~QueryPool() {
  for (Lane* lane : {&usual_, &last_}) {
    lane->waiting.close();
    for (std::thread& thread : lane->threads) thread.join();
  }
}

void QueryPool::ask(Question question, bool compressed, Respond respond) {
  Waiting waiting{std::move(question), compressed, std::move(respond)};
  Lane& lane = allowance_.is_left(SteadyClock::now()) ? usual_ : last_;
  if (lane.waiting.offer(std::move(waiting))) return;
  HttpResponse busy = problem(503, "busy", "too many questions wait; ask again in a second");
  busy.headers.emplace_back("Retry-After", "1");
  waiting.respond(std::move(busy));
}

void QueryPool::run(Lane& lane) {
  // A nice thread would keep one that wakes up waiting for a slice of time; an idle one gives way
  // at once.
  if (&lane == &usual_) {
    ::setpriority(PRIO_PROCESS, 0, usual_niceness);
  } else {
    const sched_param none{};
    ::sched_setscheduler(0, SCHED_IDLE, &none);
  }
  while (const auto next = lane.waiting.next()) {
    const double before = processor_time();
    HttpResponse response = answer(next->question);
    if (next->compressed) compress(response);
    if (&lane == &usual_) allowance_.take(processor_time() - before);
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
